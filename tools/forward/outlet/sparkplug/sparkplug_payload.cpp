#include "tools/forward/outlet/sparkplug/sparkplug_payload.hpp"

#include <fmt/format.h>

#include "schema/sparkplug.pb.h"

namespace fieldcast::forward {

namespace {

using sparkplug::SparkplugMetric;
using sparkplug::SparkplugPayload;
using sparkplug::SparkplugPropertySet;

constexpr std::uint32_t kInt32Type = 3, kDoubleType = 10, kBooleanType = 11, kStringType = 12;

// Times before 1970 are 0.
std::uint64_t milliseconds_of(UtcTime time) {
  return time.nanoseconds <= 0 ? 0 : static_cast<std::uint64_t>(time.nanoseconds / 1'000'000);
}

void set_long(SparkplugMetric& out, MetricType type, std::uint64_t number) {
  switch (type) {
    case MetricType::kInt64:
    case MetricType::kUInt64: out.set_long_value(number); break;
    default: out.set_int_value(static_cast<std::uint32_t>(number)); break;
  }
}

// Signed integers are in two's complement.
struct SetValue {
  SparkplugMetric& out;
  MetricType type;
  void operator()(bool flag) const { out.set_boolean_value(flag); }
  void operator()(std::int64_t number) const {
    set_long(out, type, static_cast<std::uint64_t>(number));
  }
  void operator()(std::uint64_t number) const { set_long(out, type, number); }
  void operator()(double number) const {
    if (type == MetricType::kFloat) {
      out.set_float_value(static_cast<float>(number));
    } else {
      out.set_double_value(number);
    }
  }
  void operator()(const std::string& text) const { out.set_string_value(text); }
};

void add_text(SparkplugPropertySet& set, const char* key, const std::string& text) {
  if (text.empty()) return;
  set.add_keys(key);
  auto& value = *set.add_values();
  value.set_type(kStringType);
  value.set_string_value(text);
}

void add_number(SparkplugPropertySet& set, const char* key, const std::optional<double>& number) {
  if (!number) return;
  set.add_keys(key);
  auto& value = *set.add_values();
  value.set_type(kDoubleType);
  value.set_double_value(*number);
}

void add_channel(SparkplugPropertySet& set, const StationChannel& channel, bool is_writable) {
  add_text(set, "engUnit", channel.unit);
  add_text(set, "documentation", channel.description);
  set.add_keys("readOnly");
  auto& value = *set.add_values();
  value.set_type(kBooleanType);
  value.set_boolean_value(!is_writable);
  add_number(set, "lowLow", channel.limits.low_low);
  add_number(set, "low", channel.limits.low);
  add_number(set, "high", channel.limits.high);
  add_number(set, "highHigh", channel.limits.high_high);
}

void fill(SparkplugMetric& out, const Metric& metric, bool is_birth) {
  if (is_birth) {
    out.set_name(metric.name);
    out.set_datatype(static_cast<std::uint32_t>(metric.type));
  }
  if (metric.alias) out.set_alias(*metric.alias);
  out.set_timestamp(milliseconds_of(metric.at));
  if (metric.is_historical) out.set_is_historical(true);
  if (metric.value) {
    std::visit(SetValue{out, metric.type}, *metric.value);
  } else {
    out.set_is_null(true);
  }
  if (metric.quality) {
    auto& set = *out.mutable_properties();
    set.add_keys("Quality");
    auto& value = *set.add_values();
    value.set_type(kInt32Type);
    value.set_int_value(quality_code(*metric.quality));
  }
  if (metric.channel != nullptr)
    add_channel(*out.mutable_properties(), *metric.channel, metric.is_writable);
}

}  // namespace

std::uint32_t quality_code(Quality quality) {
  constexpr std::uint32_t kGood = 192, kStale = 500, kBad = 0;
  switch (quality) {
    case Quality::kGood: return kGood;
    case Quality::kUncertain:
    case Quality::kNotYetRead: return kStale;
    default: return kBad;
  }
}

bool has_value(Quality quality) {
  return quality == Quality::kGood || quality == Quality::kUncertain;
}

std::string encode_payload(const std::vector<Metric>& metrics, std::optional<std::uint8_t> seq,
                           UtcTime now, bool is_birth) {
  SparkplugPayload payload;
  payload.set_timestamp(milliseconds_of(now));
  if (seq) payload.set_seq(*seq);
  for (const Metric& metric : metrics) fill(*payload.add_metrics(), metric, is_birth);
  return payload.SerializeAsString();
}

namespace {

// Keeps the bits of an integer: its sign follows from the type of the channel.
std::optional<Value> raw_value_of(const SparkplugMetric& metric) {
  if (metric.is_null()) return std::nullopt;
  switch (metric.value_case()) {
    case SparkplugMetric::kIntValue: return Value(std::uint64_t{metric.int_value()});
    case SparkplugMetric::kLongValue: return Value(std::uint64_t{metric.long_value()});
    case SparkplugMetric::kFloatValue: return Value(double{metric.float_value()});
    case SparkplugMetric::kDoubleValue: return Value(metric.double_value());
    case SparkplugMetric::kBooleanValue: return Value(metric.boolean_value());
    case SparkplugMetric::kStringValue: return Value(metric.string_value());
    case SparkplugMetric::VALUE_NOT_SET: break;
  }
  return std::nullopt;
}

}  // namespace

std::string CommandMetric::text() const {
  return name.empty() ? fmt::format("alias {}", alias.value_or(0)) : name;
}

std::optional<Value> value_of(const CommandMetric& metric, MetricType type) {
  if (!metric.raw) return std::nullopt;
  Value value = *metric.raw;
  const bool is_unsigned =
      type == MetricType::kUInt8 || type == MetricType::kUInt16 || type == MetricType::kUInt64;
  if (const auto* bits = std::get_if<std::uint64_t>(&value); bits != nullptr && !is_unsigned)
    value = metric.is_long ? static_cast<std::int64_t>(*bits)
                           : std::int64_t{static_cast<std::int32_t>(*bits)};
  const bool is_real = type == MetricType::kFloat && std::holds_alternative<double>(value);
  return is_real || fits(type, value) ? std::optional(std::move(value)) : std::nullopt;
}

std::optional<HostCommand> decode_command(std::string_view payload) {
  constexpr std::uint64_t kLatest = INT64_MAX / 1'000'000;
  SparkplugPayload decoded;
  if (!decoded.ParseFromArray(payload.data(), static_cast<int>(payload.size())))
    return std::nullopt;
  HostCommand command;
  if (decoded.timestamp() <= kLatest)
    command.at = {static_cast<std::int64_t>(decoded.timestamp()) * 1'000'000};
  for (const SparkplugMetric& metric : decoded.metrics()) {
    if (metric.name() == kRebirth) {
      command.rebirth |= metric.boolean_value();
    } else if (command.metrics.size() < kMostCommanded) {
      command.metrics.push_back(
          {.name = metric.name(),
           .alias = metric.has_alias() ? std::optional(metric.alias()) : std::nullopt,
           .raw = raw_value_of(metric),
           .is_long = metric.has_long_value()});
    }
  }
  return command;
}

}  // namespace fieldcast::forward
