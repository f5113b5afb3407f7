#include "tools/forward/batch/sample_batch.hpp"

#include <bit>
#include <optional>

namespace fieldcast::forward {

namespace {

// FNV-1a over 64-bit words, with a shift that also mixes the upper half.
class Hash {
 public:
  Hash& add(std::uint64_t word) {
    state_ = (state_ ^ word) * 0x100000001b3;
    state_ ^= state_ >> 29;
    return *this;
  }
  Hash& add(std::int64_t word) { return add(static_cast<std::uint64_t>(word)); }
  Hash& add(double number) { return add(std::bit_cast<std::uint64_t>(number)); }
  Hash& add(bool flag) { return add(std::uint64_t{flag}); }
  Hash& add(UtcTime time) { return add(time.nanoseconds); }
  Hash& add(std::string_view text) {
    add(std::uint64_t{text.size()});
    for (const char byte : text) add(std::uint64_t{static_cast<unsigned char>(byte)});
    return *this;
  }
  Hash& add(const std::optional<double>& number) {
    return add(number.has_value()).add(number.value_or(0));
  }
  template <class Enum>
  requires std::is_enum_v<Enum> Hash& add(Enum value) {
    return add(static_cast<std::uint64_t>(value));
  }
  Hash& add(const AlarmPause& pause) {
    return add(std::string_view(pause.by))
        .add(std::string_view(pause.note))
        .add(pause.since)
        .add(pause.until);
  }
  [[nodiscard]] std::uint64_t value() const { return state_ ^ (state_ >> 32); }

 private:
  std::uint64_t state_ = 0xcbf29ce484222325;
};

}  // namespace

std::uint64_t identity_of(const SampleBatch& batch) {
  Hash hash;
  hash.add(std::string_view(batch.bus)).add(std::string_view(batch.device));
  hash.add(batch.epoch).add(batch.catalogue);
  for (const BatchSample& sample : batch.samples)
    hash.add(std::uint64_t{sample.channel}).add(sample.sequence);
  return hash.value();
}

std::uint64_t identity_of(const DeviceCatalogue& catalogue) {
  Hash hash;
  hash.add(std::string_view(catalogue.bus)).add(std::string_view(catalogue.device));
  for (const StationChannel& channel : catalogue.channels) {
    for (const std::string* text :
         {&channel.channel, &channel.type, &channel.unit, &channel.at, &channel.description})
      hash.add(std::string_view(*text));
    hash.add(channel.access).add(channel.mode).add(std::int64_t{channel.refresh.count()});
    const Limits& limits = channel.limits;
    hash.add(limits.low_low).add(limits.low).add(limits.high).add(limits.high_high);
    hash.add(channel.write_min).add(channel.write_max);
  }
  return hash.value();
}

std::uint64_t identity_of(const StationAlarmStatus& alarm) {
  Hash hash;
  const AlarmStatus& status = alarm.status;
  hash.add(std::string_view(alarm.alarm.bus)).add(std::string_view(alarm.alarm.device));
  hash.add(std::string_view(alarm.alarm.channel)).add(alarm.alarm.limit);
  hash.add(status.priority).add(status.stage).add(status.active).add(status.value);
  hash.add(status.raised_at).add(status.cleared_at).add(status.acknowledged.at);
  hash.add(std::string_view(status.acknowledged.by));
  hash.add(std::string_view(status.acknowledged.note));
  hash.add(status.shelved).add(status.suppressed);
  return hash.value();
}

std::uint64_t identity_of(const AuditReport& entry) {
  return Hash().add(std::string_view(entry.bridge)).add(entry.epoch).add(entry.number).value();
}

std::optional<Position> next_position(const Position& known, const StationAlarmStatus& alarm) {
  const std::uint64_t identity = identity_of(alarm);
  if (identity == known.sequence) return std::nullopt;
  return Position{known.epoch + 1, identity};
}

}  // namespace fieldcast::forward
