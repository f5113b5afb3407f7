#include "tools/station/stream/message_decoder.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "tools/forward/outlet/nats/subject.hpp"
#include "tools/forward/payload/codec.hpp"
#include "tools/forward/payload/compression.hpp"

namespace fieldcast::web {

namespace {

// Returns the content as protobuf.
tl::expected<std::string, MessageFault> content_of(std::string_view data) {
  auto content = forward::decompressed(data);
  if (!content) return tl::make_unexpected(MessageFault::kFrame);
  const auto schema = forward::schema_of(*content);
  if (!schema) return tl::make_unexpected(MessageFault::kForm);
  if (*schema != forward::kSchema) return tl::make_unexpected(MessageFault::kSchema);
  return *std::move(content);
}

}  // namespace

std::string_view to_text(MessageFault fault) {
  switch (fault) {
    case MessageFault::kSubject: return "the subject does not name a site, a bus and a device";
    case MessageFault::kFrame: return "the zstd frame is damaged or too large";
    case MessageFault::kForm:
      return "the content is not protobuf; this station reads no other form";
    case MessageFault::kSchema:
      return "the version of the message is not supported; update this station";
    case MessageFault::kContent: return "the content cannot be decoded";
    case MessageFault::kCatalogue:
      return "the bucket does not have its catalogue; restart the forwarder of the site";
  }
  return "?";
}

std::optional<StreamSubject> stream_subject_from(std::string_view subject) {
  std::array<std::string_view, 4> tokens;
  for (std::size_t i = 0; i < tokens.size(); ++i) {
    const std::size_t dot = subject.find('.');
    if ((dot == subject.npos) != (i + 1 == tokens.size())) return std::nullopt;
    tokens[i] = subject.substr(0, dot);
    subject.remove_prefix(dot == subject.npos ? subject.size() : dot + 1);
  }
  StreamSubject found{.site = forward::name_of_token(tokens[1]),
                      .bus = forward::name_of_token(tokens[2]),
                      .device = forward::name_of_token(tokens[3]),
                      .is_late = tokens[0] == forward::kLateSubjects};
  const bool is_known = found.is_late || tokens[0] == forward::kSampleSubjects ||
                        tokens[0] == forward::kAlarmSubjects;
  if (!is_known || found.site.empty() || found.bus.empty() || found.device.empty())
    return std::nullopt;
  return found;
}

tl::expected<StreamBatch, MessageFault> decode_batch(const StreamMessage& message,
                                                     const FindCatalogue& find) {
  const auto subject = stream_subject_from(message.subject);
  if (!subject) return tl::make_unexpected(MessageFault::kSubject);
  const auto content = content_of(message.data);
  if (!content) return tl::make_unexpected(content.error());
  auto samples = forward::decode_samples(*content);
  if (!samples) return tl::make_unexpected(MessageFault::kContent);
  SharedCatalogue catalogue =
      find(subject->site, subject->bus, subject->device, samples->catalogue);
  const auto is_beyond = [&](const forward::BatchSample& sample) {
    return sample.channel >= catalogue->channels.size();
  };
  if (catalogue == nullptr || std::ranges::any_of(samples->samples, is_beyond))
    return tl::make_unexpected(MessageFault::kCatalogue);
  samples->bus = bus_of_site(subject->site, subject->bus);
  samples->device = subject->device;
  return StreamBatch{.site = subject->site,
                     .is_late = subject->is_late,
                     .stored_at = message.stored_at,
                     .samples = *std::move(samples),
                     .catalogue = std::move(catalogue)};
}

tl::expected<StationAlarmStatus, MessageFault> decode_alarm(const StreamMessage& message) {
  const auto subject = stream_subject_from(message.subject);
  if (!subject) return tl::make_unexpected(MessageFault::kSubject);
  const auto content = content_of(message.data);
  if (!content) return tl::make_unexpected(content.error());
  auto alarm = forward::decode_alarm(*content);
  if (!alarm) return tl::make_unexpected(MessageFault::kContent);
  alarm->alarm.bus = bus_of_site(subject->site, subject->bus);
  alarm->alarm.device = subject->device;
  return *std::move(alarm);
}

tl::expected<forward::DeviceCatalogue, MessageFault> decode_catalogue(const std::string& site,
                                                                      std::string_view data) {
  const auto content = content_of(data);
  if (!content) return tl::make_unexpected(content.error());
  auto catalogue = forward::decode_catalogue(*content);
  if (!catalogue) return tl::make_unexpected(MessageFault::kContent);
  catalogue->bus = bus_of_site(site, catalogue->bus);
  for (StationChannel& channel : catalogue->channels) channel.bus = catalogue->bus;
  return *std::move(catalogue);
}

}  // namespace fieldcast::web
