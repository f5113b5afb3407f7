#include "bridge/dds/receivers/interest_receiver.hpp"

#include <fastdds/dds/subscriber/SampleInfo.hpp>

namespace fieldcast {

InterestReceiver::InterestReceiver(Domain& domain, std::function<void(Interest)> handler,
                                   std::function<void(std::string)> on_problem)
    : domain_(domain), handler_(std::move(handler)), on_problem_(std::move(on_problem)) {
  reader_ =
      domain.reader(kInterestTopic, this,
                    dds::StatusMask::data_available() << dds::StatusMask::subscription_matched()
                                                      << dds::StatusMask::sample_rejected());
  lease_reader_ = domain.reader(kInterestTopic, lease_reader_qos(), this,
                                dds::StatusMask::liveliness_changed());
}

void InterestReceiver::close() {
  domain_.remove(lease_reader_);
  domain_.remove(reader_);
}

void InterestReceiver::on_data_available(dds::DataReader* reader) {
  const std::lock_guard lock(mutex_);
  idl::Interest sample;
  dds::SampleInfo info;
  while (reader->take_next_sample(&sample, &info) == ReturnCode_t::RETCODE_OK) {
    const auto known = known_.find(info.instance_handle);
    lost_.forget(info.publication_handle, info.instance_handle);
    if (info.valid_data && info.instance_state == dds::ALIVE_INSTANCE_STATE) {
      std::optional<Interest> interest = from_idl(sample);
      if (!interest) {
        refuse(sample, "it needs a station, a pattern and a refresh longer than nothing");
        continue;
      }
      if (known == known_.end() && known_.size() >= static_cast<std::size_t>(kMaxInterests)) {
        refuse(sample, std::to_string(kMaxInterests) + " are held already");
        continue;
      }
      known_[info.instance_handle] = {*interest, info.publication_handle, false};
      handler_(std::move(*interest));
    } else if (info.instance_state != dds::ALIVE_INSTANCE_STATE && known != known_.end()) {
      const Known ended = std::move(known->second);
      known_.erase(known);
      if (!ended.silent) end(ended.interest);
    }
  }
}

void InterestReceiver::end(Interest interest) {
  interest.refresh.reset();
  handler_(std::move(interest));
}

void InterestReceiver::refuse(const idl::Interest& interest, const std::string& why) {
  refuse("the interest of station '" + std::string(interest.station().c_str()) + "' in '" +
         interest.pattern().c_str() + "' is refused: " + why);
}

void InterestReceiver::refuse(const std::string& text) {
  const std::uint64_t refused = ++refused_;
  std::uint64_t reported = 1;
  while (reported < refused) reported *= 10;
  if (refused == reported) on_problem_(text + "; refused so far: " + std::to_string(refused));
}

// The library holds as many instances as this object, and accepts no more until one ends. It calls
// this function with the reader's lock held, so mutex_ is not locked.
void InterestReceiver::on_sample_rejected(dds::DataReader*, const dds::SampleRejectedStatus&) {
  refuse("interests are refused: stations declare more than the " + std::to_string(kMaxInterests) +
         " that a bridge holds");
}

void InterestReceiver::on_subscription_matched(dds::DataReader*,
                                               const dds::SubscriptionMatchedStatus& status) {
  const std::lock_guard lock(mutex_);
  if (status.current_count_change < 0) end_of(status.last_publication_handle);
  if (status.current_count_change > 0) return_of(status.last_publication_handle);
}

// A station crashed or left without withdrawing: the library delivers no unregister messages.
void InterestReceiver::end_of(const dds::InstanceHandle_t& writer) {
  for (auto one = known_.begin(); one != known_.end();) {
    if (one->second.writer != writer) {
      ++one;
      continue;
    }
    auto ended = known_.extract(one++);
    if (!ended.mapped().silent) end(ended.mapped().interest);
    lost_.keep(writer, ended.key(), std::move(ended.mapped().interest));
  }
}

void InterestReceiver::return_of(const dds::InstanceHandle_t& writer) {
  for (auto& [instance, interest] : lost_.take(writer)) {
    if (known_.size() >= static_cast<std::size_t>(kMaxInterests)) {
      refuse(std::to_string(kMaxInterests) + " interests are held already");
    } else if (known_.try_emplace(instance, Known{interest, writer, false}).second) {
      handler_(std::move(interest));
    }
  }
}

void InterestReceiver::on_liveliness_changed(dds::DataReader*,
                                             const dds::LivelinessChangedStatus& status) {
  if (status.alive_count_change == 0) return;
  const bool silent = status.alive_count_change < 0;
  const std::lock_guard lock(mutex_);
  for (auto& [instance, one] : known_) {
    if (one.writer != status.last_publication_handle || one.silent == silent) continue;
    one.silent = silent;
    silent ? end(one.interest) : handler_(one.interest);
  }
}

}  // namespace fieldcast
