#include "bridge/dds/alarm_action_receiver.hpp"

#include <fastdds/dds/subscriber/SampleInfo.hpp>

namespace fieldcast {

AlarmActionReceiver::AlarmActionReceiver(Domain& domain, const CommandLifespans& lifespans,
                                         Handlers handlers, HeldTo bus)
    : domain_(domain),
      lifespans_(lifespans),
      handlers_(std::move(handlers)),
      bus_(std::move(bus)),
      listening_(handlers_.clock().instant) {
  const auto mask = dds::StatusMask::data_available();
  reader_ = bus_ ? domain.reader_of_bus(*bus_, kAlarmActionTopic, this, mask)
                 : domain.reader(kAlarmActionTopic, this, mask);
}

void AlarmActionReceiver::close() { domain_.remove(reader_); }

void AlarmActionReceiver::on_data_available(dds::DataReader* reader) {
  idl::AlarmAction action;
  dds::SampleInfo info;
  while (reader->take_next_sample(&action, &info) == ReturnCode_t::RETCODE_OK) {
    if (info.valid_data) take(action, info);
  }
}

void AlarmActionReceiver::take(const idl::AlarmAction& action, const dds::SampleInfo& info) {
  const std::string bus = action.bus().c_str();
  if (!handlers_.is_ours(bus) || (bus_ && bus != *bus_)) return;
  const CommandLifespans::Guid writer = info.sample_identity.writer_guid();
  const auto subject =
      subject_of_requester(domain_, lifespans_.requesters(), action.requester().c_str(), writer);
  if (!subject)
    return handlers_.on_problem("an action under the name of another's requester was dropped");
  handlers_.received(action.requester().c_str(), writer);
  const UtcTime source{info.source_timestamp.to_ns()};
  const UtcMapping now = handlers_.clock();
  if (written_before(listening_, source, now)) {
    return handlers_.refused(action, {Cause::kExpired,
                                      "it was written before this bridge began to listen, by the "
                                      "clocks of both; if it is still wanted, send it anew"});
  }
  if (expiry_of(source, lifespans_.of(writer), now) < now.instant)
    return handlers_.refused(action, {Cause::kExpired, "it came too late"});
  auto converted = from_idl(action);
  if (!converted) return handlers_.refused(action, converted.error());
  handlers_.accepted(*std::move(converted));
}

}  // namespace fieldcast
