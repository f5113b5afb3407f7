#include "tools/station/stream/message_decoder.hpp"

#include <algorithm>
#include <array>
#include <unordered_map>
#include <utility>

#include "tools/forward/outlet/nats/subject.hpp"
#include "tools/forward/payload/codec.hpp"
#include "tools/forward/payload/compression.hpp"
#include "tools/forward/payload/json_decoder.hpp"

namespace fieldcast::web {

namespace {

// Calls `protobuf` or `json` with the content of a message, and returns what that returns.
template <class Made>
tl::expected<Made, DecodeFault> decoded(std::string_view data,
                                        std::optional<Made> (*protobuf)(std::string_view),
                                        std::optional<Made> (forward::JsonPayload::*json)() const) {
  const auto content = forward::decompressed(data);
  if (!content) return tl::make_unexpected(DecodeFault::kFrame);
  const bool is_json = content->starts_with('{');
  const auto payload = is_json ? forward::JsonPayload::parse(*content) : std::nullopt;
  if (is_json && !payload) return tl::make_unexpected(DecodeFault::kForm);
  const auto schema = is_json ? payload->schema() : forward::schema_of(*content);
  if (!schema) return tl::make_unexpected(DecodeFault::kForm);
  if (*schema != forward::kSchema) return tl::make_unexpected(DecodeFault::kSchema);
  auto made = is_json ? ((*payload).*json)() : protobuf(*content);
  if (!made) return tl::make_unexpected(DecodeFault::kContent);
  return *std::move(made);
}

std::optional<forward::NamedSamples> samples_by_index(std::string_view text) {
  auto batch = forward::decode_samples(text);
  if (!batch) return std::nullopt;
  return forward::NamedSamples{*std::move(batch), {}};
}

// Sets the index of each sample that has only a name. Returns false if a channel is unknown.
bool find_channels(forward::NamedSamples& named, const forward::DeviceCatalogue& catalogue) {
  std::unordered_map<std::string_view, std::uint32_t> index;
  if (!named.channels.empty()) {
    for (std::uint32_t i = 0; i < catalogue.channels.size(); ++i)
      index.emplace(catalogue.channels[i].channel, i);
  }
  for (std::size_t i = 0; i < named.channels.size(); ++i) {
    const auto found = index.find(named.channels[i]);
    if (found == index.end()) return false;
    named.batch.samples[i].channel = found->second;
  }
  return std::ranges::all_of(named.batch.samples, [&](const forward::BatchSample& sample) {
    return sample.channel < catalogue.channels.size();
  });
}

}  // namespace

std::string_view to_text(DecodeFault fault) {
  switch (fault) {
    case DecodeFault::kSubject: return "the subject does not name a site, a bus and a device";
    case DecodeFault::kFrame: return "the zstd frame is damaged or too large";
    case DecodeFault::kForm: return "the content is neither protobuf nor JSON";
    case DecodeFault::kSchema:
      return "the version of the message is not supported; update this station";
    case DecodeFault::kContent: return "the content cannot be decoded";
    case DecodeFault::kCatalogue:
      return "the bucket does not have its catalogue; restart the forwarder of the site";
    case DecodeFault::kTaken:
      return "a site of this station in DDS has the same name; rename one of the two";
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

tl::expected<StreamBatch, DecodeFault> decode_batch(const StreamMessage& message,
                                                    const FindCatalogue& find) {
  const auto subject = stream_subject_from(message.subject);
  if (!subject) return tl::make_unexpected(DecodeFault::kSubject);
  auto named = decoded(message.data, samples_by_index, &forward::JsonPayload::samples);
  if (!named) return tl::make_unexpected(named.error());
  forward::SampleBatch& samples = named->batch;
  SharedCatalogue catalogue = find(subject->site, subject->bus, subject->device, samples.catalogue);
  if (catalogue == nullptr || !find_channels(*named, *catalogue))
    return tl::make_unexpected(DecodeFault::kCatalogue);
  samples.bus = bus_of_site(subject->site, subject->bus);
  samples.device = subject->device;
  return StreamBatch{.site = subject->site,
                     .is_late = subject->is_late,
                     .stored_at = message.stored_at,
                     .samples = std::move(samples),
                     .catalogue = std::move(catalogue)};
}

tl::expected<StationAlarmStatus, DecodeFault> decode_alarm(const StreamMessage& message) {
  const auto subject = stream_subject_from(message.subject);
  if (!subject) return tl::make_unexpected(DecodeFault::kSubject);
  auto alarm = decoded(message.data, forward::decode_alarm, &forward::JsonPayload::alarm);
  if (!alarm) return tl::make_unexpected(alarm.error());
  alarm->alarm.bus = bus_of_site(subject->site, subject->bus);
  alarm->alarm.device = subject->device;
  return *std::move(alarm);
}

tl::expected<forward::DeviceCatalogue, DecodeFault> decode_catalogue(const std::string& site,
                                                                     std::string_view data) {
  auto catalogue = decoded(data, forward::decode_catalogue, &forward::JsonPayload::catalogue);
  if (!catalogue) return tl::make_unexpected(catalogue.error());
  catalogue->bus = bus_of_site(site, catalogue->bus);
  for (StationChannel& channel : catalogue->channels) channel.bus = catalogue->bus;
  return *std::move(catalogue);
}

}  // namespace fieldcast::web
