#include "bridge/dds/endpoints/standby_channel.hpp"

#include <algorithm>

#include "bridge/dds/topics/conversion.hpp"

namespace fieldcast {

StandbyChannel::StandbyChannel(Domain& domain, const std::string& label, std::string group,
                               UtcTime since, StandbyChannelHandlers handlers)
    : domain_(domain),
      group_(std::move(group)),
      handlers_(std::move(handlers)),
      members_(*this, [this](const idl::Standby& message,
                             const dds::SampleInfo& info) { on_member(message, info); }),
      notes_([this](const idl::StandbyNote& note, const dds::SampleInfo&) {
        if (note.group() == group_) handlers_.note(from_idl(note));
      }),
      requests_([this](const idl::StandbyRequest& request, const dds::SampleInfo&) {
        if (request.group() == group_) handlers_.request(from_idl(request));
      }) {
  const auto data = dds::StatusMask::data_available();
  const auto ownership = static_cast<std::int32_t>(since.nanoseconds / 1'000'000'000);
  member_writer_ = domain.writer(kStandbyTopic, standby_writer_qos(ownership), label);
  note_writer_ = domain.writer(kStandbyNoteTopic, label);
  note_reader_ = domain.reader(kStandbyNoteTopic, &notes_, data);
  request_reader_ = domain.reader(kStandbyRequestTopic, &requests_, data);
  member_reader_ = domain.reader(kStandbyTopic, &members_,
                                 dds::StatusMask(data) << dds::StatusMask::subscription_matched());
}

StandbyChannel::~StandbyChannel() { close(); }

void StandbyChannel::close() {
  for (dds::DataReader** reader : {&member_reader_, &note_reader_, &request_reader_}) {
    if (*reader != nullptr) domain_.remove(*reader);
    *reader = nullptr;
  }
  for (dds::DataWriter** writer : {&member_writer_, &note_writer_}) {
    if (*writer != nullptr) domain_.remove(*writer);
    *writer = nullptr;
  }
}

void StandbyChannel::tell(const StandbyMessage& message) {
  idl::Standby out;
  to_idl(message, out);
  member_writer_->write(&out);
}

void StandbyChannel::tell(const StandbyNote& note) {
  idl::StandbyNote out;
  to_idl(note, out);
  note_writer_->write(&out);
}

void StandbyChannel::on_member(const idl::Standby& message, const dds::SampleInfo& info) {
  if (message.group() != group_) return;
  const auto told = from_idl(message);
  if (!told) return;
  {
    const std::lock_guard lock(mutex_);
    if (bridges_.size() < static_cast<std::size_t>(kMaxStandbyMembers))
      bridges_[info.publication_handle] = told->member.bridge;
  }
  handlers_.member(*told);
}

void StandbyChannel::on_gone(const dds::InstanceHandle_t& writer) {
  std::string bridge;
  {
    const std::lock_guard lock(mutex_);
    const auto found = bridges_.find(writer);
    if (found == bridges_.end()) return;
    bridge = found->second;
    bridges_.erase(found);
    // The removed writer is of an earlier run of a bridge that is present again.
    if (std::ranges::any_of(bridges_, [&](const auto& other) { return other.second == bridge; }))
      return;
  }
  handlers_.lost(bridge);
}

}  // namespace fieldcast
