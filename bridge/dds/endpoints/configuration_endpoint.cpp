#include "bridge/dds/endpoints/configuration_endpoint.hpp"

#include <utility>

namespace fieldcast {

ConfigurationEndpoint::ConfigurationEndpoint(Domain& domain, const std::string& bridge,
                                             const std::string& label, Instant now,
                                             Received received)
    : domain_(domain),
      bridge_(bridge),
      listening_(now),
      received_(std::move(received)),
      taker_([this](const idl::ConfigurationRequest& part, const dds::SampleInfo& info) {
        take(part, info);
      }),
      writer_(domain.writer(kConfigurationReplyTopic, label)),
      reader_(
          domain.reader(kConfigurationRequestTopic, &taker_, dds::StatusMask::data_available())) {}

void ConfigurationEndpoint::take(const idl::ConfigurationRequest& part,
                                 const dds::SampleInfo& info) {
  if (bridge_ != part.bridge().c_str()) return;
  const rtps::GUID_t writer = info.sample_identity.writer_guid();
  if (part.part() == 0) {
    // A requester that vanished within a request must not block others.
    if (!incomplete_.contains(writer) && incomplete_.size() >= kMaxIncomplete)
      incomplete_.erase(incomplete_.begin());
    incomplete_[writer] = {part.request_id(), {}};
  }
  const auto found = incomplete_.find(writer);
  if (found == incomplete_.end() || found->second.request_id != part.request_id()) return;
  const auto added = found->second.parts.add(part);
  if (added == ConfigurationParts::Added::kMore) return;
  ConfigurationMessage request{part.requester().c_str(), part.request_id(), bridge_,
                               found->second.parts.take()};
  incomplete_.erase(found);
  if (added == ConfigurationParts::Added::kWhole)
    received_(std::move(request),
              RequestOrigin{writer, {info.source_timestamp.to_ns()}, std::nullopt, listening_});
}

void ConfigurationEndpoint::respond(const ConfigurationMessage& reply) {
  to_parts<idl::ConfigurationReply>(reply, [this](idl::ConfigurationReply& part) {
    if (pace_.is_closed()) return;
    writer_->write(&part);
    if (!part.last()) pace_.rest();
  });
}

void ConfigurationEndpoint::close() {
  pace_.close();
  if (reader_ != nullptr) domain_.remove(std::exchange(reader_, nullptr));
}

}  // namespace fieldcast
