#include "tools/forward/payload/json_decoder.hpp"

#include <charconv>

#include "tools/forward/payload/names.hpp"

namespace fieldcast::forward {

namespace {

using Tree = nlohmann::json;

// Reads members of one object. Each function notes a fault if the member is missing or has another
// type, and returns a default.
class Members {
 public:
  explicit Members(const Tree& object) : object_(object), has_fault_(!object.is_object()) {}

  [[nodiscard]] bool has_fault() const { return has_fault_; }

  std::string text(const char* name) {
    const Tree* const found = find(name);
    if (found == nullptr || !found->is_string()) return fault(std::string{});
    return found->get<std::string>();
  }
  template <class Number>
  Number whole(const char* name) {
    const Tree* const found = find(name);
    if (found == nullptr) return fault(Number{});
    if (found->is_number_unsigned() && std::in_range<Number>(found->get<std::uint64_t>()))
      return static_cast<Number>(found->get<std::uint64_t>());
    if (found->is_number_integer() && std::in_range<Number>(found->get<std::int64_t>()))
      return static_cast<Number>(found->get<std::int64_t>());
    return fault(Number{});
  }
  UtcTime time(const char* name) { return {whole<std::int64_t>(name)}; }
  bool boolean(const char* name) {
    const Tree* const found = find(name);
    return found != nullptr && found->is_boolean() ? found->get<bool>() : fault(false);
  }
  // Empty for null.
  std::optional<double> number(const char* name) {
    const Tree* const found = find(name);
    if (found != nullptr && found->is_number()) return found->get<double>();
    if (found == nullptr || !found->is_null()) has_fault_ = true;
    return std::nullopt;
  }
  // "187c0e0f1a2b3c4d"
  std::uint64_t hex(const char* name) {
    const std::string digits = text(name);
    std::uint64_t number = 0;
    const char* const end = digits.data() + digits.size();
    const auto read = std::from_chars(digits.data(), end, number, 16);
    return read.ec == std::errc{} && read.ptr == end ? number : fault(std::uint64_t{});
  }
  template <class Enum, std::size_t N>
  Enum named(const char* name, const std::array<Enum, N>& all) {
    const auto found = enum_from(all, text(name));
    return found ? *found : fault(all.front());
  }
  const Tree* find(const char* name) const {
    if (!object_.is_object()) return nullptr;
    const auto found = object_.find(name);
    return found == object_.end() ? nullptr : &*found;
  }
  // The items of an array.
  const Tree::array_t& items(const char* name) {
    static const Tree::array_t none;
    const Tree* const found = find(name);
    if (found == nullptr || !found->is_array()) return fault(std::cref(none));
    return found->get_ref<const Tree::array_t&>();
  }

 private:
  template <class Default>
  Default fault(Default otherwise) {
    has_fault_ = true;
    return otherwise;
  }

  const Tree& object_;
  bool has_fault_;
};

// Integers stay integers: to_json() writes a real number with a point or an exponent.
std::optional<Value> value_of(const Tree* json) {
  if (json == nullptr) return std::nullopt;
  if (json->is_null()) return 0.0;
  if (json->is_boolean()) return json->get<bool>();
  if (json->is_number_float()) return json->get<double>();
  if (json->is_string()) return json->get<std::string>();
  if (json->is_number_unsigned()) {
    const auto number = json->get<std::uint64_t>();
    if (!std::in_range<std::int64_t>(number)) return number;
  }
  if (json->is_number_integer()) return json->get<std::int64_t>();
  return std::nullopt;
}

AlarmPause pause_of(const Tree* json, bool& has_fault) {
  if (json == nullptr || json->is_null() || (json->is_object() && json->empty())) return {};
  Members pause(*json);
  AlarmPause made{pause.text("by"), pause.text("note"), pause.time("since"), pause.time("until")};
  has_fault = has_fault || pause.has_fault();
  return made;
}

}  // namespace

std::optional<JsonPayload> JsonPayload::parse(std::string_view text) {
  Tree tree = Tree::parse(text, nullptr, false);
  if (!tree.is_object()) return std::nullopt;
  return JsonPayload(std::move(tree));
}

std::optional<std::uint64_t> JsonPayload::schema() const {
  Members members(tree_);
  const auto schema = members.whole<std::uint64_t>("schema");
  return members.has_fault() ? std::nullopt : std::optional(schema);
}

std::optional<NamedSamples> JsonPayload::samples() const {
  Members members(tree_);
  NamedSamples made;
  made.batch.epoch = members.hex("epoch");
  made.batch.catalogue = members.hex("catalogue");
  for (const Tree& item : members.items("samples")) {
    Members from(item);
    const auto value = value_of(from.find("value"));
    BatchSample sample{.channel = 0,
                       .sequence = from.whole<std::uint64_t>("sequence"),
                       .acquired_at = from.time("acquired_at"),
                       .value = value.value_or(Value{}),
                       .quality = from.named("quality", kQualities)};
    if (from.find("device_code") != nullptr)
      sample.device_code = from.whole<std::uint16_t>("device_code");
    made.channels.push_back(from.text("channel"));
    made.batch.samples.push_back(std::move(sample));
    if (from.has_fault() || !value) return std::nullopt;
  }
  return members.has_fault() ? std::nullopt : std::optional(std::move(made));
}

std::optional<DeviceCatalogue> JsonPayload::catalogue() const {
  Members members(tree_);
  DeviceCatalogue made{members.text("bus"), members.text("device"), {}};
  for (const Tree& item : members.items("channels")) {
    Members from(item);
    StationChannel channel{.bus = made.bus,
                           .device = made.device,
                           .channel = from.text("channel"),
                           .type = from.text("type"),
                           .unit = from.text("unit"),
                           .at = from.text("at"),
                           .description = from.text("description"),
                           .access = from.named("access", kAccesses),
                           .mode = from.named("mode", kModes),
                           .refresh = Duration{from.whole<std::int64_t>("refresh")}};
    channel.limits.low_low = from.number("low_low");
    channel.limits.low = from.number("low");
    channel.limits.high = from.number("high");
    channel.limits.high_high = from.number("high_high");
    channel.write_min = from.number("write_min");
    channel.write_max = from.number("write_max");
    if (from.has_fault()) return std::nullopt;
    made.channels.push_back(std::move(channel));
  }
  return members.has_fault() ? std::nullopt : std::optional(std::move(made));
}

std::optional<StationAlarmStatus> JsonPayload::alarm() const {
  Members members(tree_);
  const auto limit = limit_kind_from(members.text("limit"));
  if (!limit) return std::nullopt;
  StationAlarmStatus made;
  made.alarm = {members.text("bus"), members.text("device"), members.text("channel"), *limit};
  AlarmStatus& status = made.status;
  status.priority = members.named("priority", kPriorities);
  status.stage = members.named("stage", kStages);
  status.active = members.boolean("active");
  status.value = members.number("value").value_or(0);
  status.raised_at = members.time("raised_at");
  status.cleared_at = members.time("cleared_at");
  status.acknowledged = {members.text("acknowledged_by"), members.text("acknowledged_note"),
                         members.time("acknowledged_at")};
  bool has_fault = false;
  status.shelved = pause_of(members.find("shelved"), has_fault);
  status.suppressed = pause_of(members.find("suppressed"), has_fault);
  if (has_fault || members.has_fault()) return std::nullopt;
  return made;
}

}  // namespace fieldcast::forward
