#include "tools/forward/outlet/prometheus/remote_write.hpp"

#include <snappy.h>

#include <map>
#include <optional>
#include <string_view>

#include "schema/remote_write.pb.h"

namespace fieldcast::forward {

namespace {

std::int64_t milliseconds_of(const BatchSample& sample) {
  return sample.acquired_at.nanoseconds / 1'000'000;
}

std::optional<double> number_of(const Value& value) {
  if (const bool* boolean = std::get_if<bool>(&value)) return *boolean ? 1.0 : 0.0;
  return as_number(value);
}

// protobuf accepts only UTF-8; a name has at most ASCII and what the configuration allows.
void add_label(prometheus::TimeSeries& series, const char* name, std::string_view value) {
  prometheus::Label& label = *series.add_labels();
  label.set_name(name);
  label.set_value(std::string(value));
}

class Writer {
 public:
  Writer(std::string_view site, const SampleBatch& batch) : site_(site), batch_(batch) {}

  void add(const BatchSample& sample, const std::string& channel, double value) {
    const std::int64_t at = milliseconds_of(sample);
    append(series(sample, channel, "fieldcast_value"), at, value);
    append(series(sample, channel, "fieldcast_sequence"), at, static_cast<double>(sample.sequence));
  }
  [[nodiscard]] std::string text() const { return request_.SerializeAsString(); }

 private:
  struct Key {
    std::uint32_t channel;
    Quality quality;
    std::string_view metric;
    friend auto operator<=>(const Key&, const Key&) = default;
  };

  static void append(prometheus::TimeSeries& to, std::int64_t at, double value) {
    prometheus::Sample& added = *to.add_samples();
    added.set_value(value);
    added.set_timestamp(at);
  }

  prometheus::TimeSeries& series(const BatchSample& sample, const std::string& channel,
                                 const char* metric) {
    auto& known = series_[Key{sample.channel, sample.quality, metric}];
    if (known != nullptr) return *known;
    known = request_.add_timeseries();
    add_label(*known, "__name__", metric);
    add_label(*known, "bus", batch_.bus);
    add_label(*known, "channel", channel);
    add_label(*known, "device", batch_.device);
    add_label(*known, "quality", to_text(sample.quality));
    add_label(*known, "site", site_);
    return *known;
  }

  const std::string_view site_;
  const SampleBatch& batch_;
  prometheus::WriteRequest request_;
  std::map<Key, prometheus::TimeSeries*> series_;  // in request_
};

}  // namespace

// A repeated record has the same samples and is encoded again. A server ignores a second late
// sample of one time by itself.
bool WriteRequestEncoder::is_first(const SampleBatch& batch, const BatchSample& sample,
                                   const std::string& channel) {
  std::string name = batch.bus + '/' + batch.device + '/' + channel + ' ';
  name += to_text(sample.quality);
  Last& last = last_[std::move(name)];
  const std::int64_t at = milliseconds_of(sample);
  if (at == last.at) return sample.sequence == last.sequence;
  if (at > last.at) last = {at, sample.sequence};
  return true;
}

std::string WriteRequestEncoder::encode(const SampleBatch& batch,
                                        const DeviceCatalogue& catalogue) {
  Writer writer(site_, batch);
  for (const BatchSample& sample : batch.samples) {
    const auto value = number_of(sample.value);
    if (!value || sample.acquired_at.nanoseconds <= 0 ||
        sample.channel >= catalogue.channels.size())
      continue;
    const std::string& channel = catalogue.channels[sample.channel].channel;
    if (is_first(batch, sample, channel)) writer.add(sample, channel, *value);
  }
  return writer.text();
}

std::string snappy_block(const std::string& text) {
  std::string packed;
  snappy::Compress(text.data(), text.size(), &packed);
  return packed;
}

}  // namespace fieldcast::forward
