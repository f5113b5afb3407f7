#include "bridge/dds/alarm_action_receiver.hpp"

#include <fastdds/dds/subscriber/SampleInfo.hpp>

namespace fieldcast {

AlarmActionReceiver::AlarmActionReceiver(Domain& domain, const CommandLifespans& lifespans,
                                         Handlers handlers)
    : domain_(domain),
      lifespans_(lifespans),
      handlers_(std::move(handlers)),
      listening_(handlers_.clock().instant) {
  reader_ = domain.reader(kAlarmActionTopic, this, dds::StatusMask::data_available());
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
  if (!handlers_.is_ours(action.bus().c_str())) return;
  const CommandLifespans::Guid writer = info.sample_identity.writer_guid();
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
