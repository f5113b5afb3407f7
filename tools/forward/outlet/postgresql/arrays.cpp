#include "tools/forward/outlet/postgresql/arrays.hpp"

#include <charconv>
#include <cmath>
#include <type_traits>

namespace fieldcast::forward {

namespace {

// Integers up to this size are exact as a double.
constexpr std::int64_t kMostExact = std::int64_t{1} << 53;

std::int64_t bits(std::uint64_t number) { return static_cast<std::int64_t>(number); }

template <class Number>
void append(std::string& to, Number number) {
  char text[32];
  to.append(text, std::to_chars(text, text + sizeof text, number).ptr);
}

// A number, and a text for what a double cannot represent.
void add_value(const Value& value, ArrayText& numbers, ArrayText& texts) {
  std::visit(
      [&](const auto& held) {
        using Held = std::decay_t<decltype(held)>;
        if constexpr (std::is_same_v<Held, std::string>) {
          numbers.add_null();
          texts.add(std::string_view(held));
          return;
        } else {
          numbers.add(std::optional<double>(static_cast<double>(held)));
        }
        bool is_exact = true;
        if constexpr (std::is_same_v<Held, std::int64_t>)
          is_exact = held >= -kMostExact && held <= kMostExact;
        if constexpr (std::is_same_v<Held, std::uint64_t>)
          is_exact = held <= static_cast<std::uint64_t>(kMostExact);
        if (is_exact) {
          texts.add_null();
        } else {
          texts.add(std::string_view(to_text(value)));
        }
      },
      value);
}

}  // namespace

void ArrayText::begin_item() {
  if (text_.size() > 1) text_ += ',';
}

void ArrayText::add(std::int64_t number) {
  begin_item();
  append(text_, number);
}

void ArrayText::add(std::optional<double> number) {
  if (!number) return add_null();
  begin_item();
  if (std::isnan(*number)) {
    text_ += "NaN";
  } else if (std::isinf(*number)) {
    text_ += *number > 0 ? "Infinity" : "-Infinity";
  } else {
    append(text_, *number);
  }
}

void ArrayText::add(std::string_view text) {
  begin_item();
  text_ += '"';
  for (const char c : text) {
    if (c == '"' || c == '\\') text_ += '\\';
    text_ += c;
  }
  text_ += '"';
}

void ArrayText::add_null() {
  begin_item();
  text_ += "NULL";
}

void SampleRows::add(const SampleBatch& batch, std::span<const std::int64_t> ids) {
  for (const BatchSample& sample : batch.samples) {
    if (sample.channel >= ids.size()) continue;
    ++size_;
    channel_.add(ids[sample.channel]);
    epoch_.add(bits(batch.epoch));
    sequence_.add(bits(sample.sequence));
    acquired_at_.add(sample.acquired_at.nanoseconds);
    quality_.add(to_text(sample.quality));
    device_code_.add(std::int64_t{sample.device_code});
    add_value(sample.value, value_, text_);
  }
}

SqlRow SampleRows::parameters() const {
  return {channel_.text(), epoch_.text(),       sequence_.text(), acquired_at_.text(),
          quality_.text(), device_code_.text(), value_.text(),    text_.text()};
}

SqlRow channel_parameters(const std::string& site, const DeviceCatalogue& catalogue) {
  ArrayText bus, device, channel, type, unit, at, description, low_low, low, high, high_high;
  for (const StationChannel& one : catalogue.channels) {
    bus.add(std::string_view(catalogue.bus));
    device.add(std::string_view(catalogue.device));
    channel.add(std::string_view(one.channel));
    type.add(std::string_view(one.type));
    unit.add(std::string_view(one.unit));
    at.add(std::string_view(one.at));
    description.add(std::string_view(one.description));
    low_low.add(one.limits.low_low);
    low.add(one.limits.low);
    high.add(one.limits.high);
    high_high.add(one.limits.high_high);
  }
  return {site,           bus.text(),  device.text(), channel.text(),
          type.text(),    unit.text(), at.text(),     description.text(),
          low_low.text(), low.text(),  high.text(),   high_high.text()};
}

SqlRow alarm_parameters(const std::string& site, const StationAlarmStatus& alarm,
                        std::uint64_t identity) {
  const AlarmStatus& status = alarm.status;
  return {site,
          bits(identity),
          alarm.alarm.bus,
          alarm.alarm.device,
          alarm.alarm.channel,
          std::string(to_text(alarm.alarm.limit)),
          std::string(to_text(status.priority)),
          std::string(to_text(status.stage)),
          std::string(status.active ? "true" : "false"),
          status.value,
          status.raised_at.nanoseconds,
          status.cleared_at.nanoseconds,
          status.acknowledged.by,
          status.acknowledged.note};
}

SqlRow audit_parameters(const std::string& site, const AuditReport& entry) {
  const auto integer = [](std::uint64_t number) { return static_cast<std::int64_t>(number); };
  return {site,
          entry.bridge,
          integer(entry.epoch),
          integer(entry.number),
          entry.at.nanoseconds,
          entry.who,
          entry.what,
          entry.target,
          integer(entry.bytes_to_device),
          integer(entry.bytes_from_device),
          entry.result};
}

}  // namespace fieldcast::forward
