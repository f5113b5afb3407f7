#include "tools/sim/device/declared_device.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "tools/sim/device/device.hpp"

namespace fieldcast::sim {
namespace {

using declared::DeclaredArea;
using declared::Field;
using declared::FieldKind;
using declared::Operation;

// For missing items; see declared_code().
constexpr std::uint8_t kAddressCode = 2;
// Each form is sent for so long, before the next one.
constexpr Duration kFormTime = std::chrono::seconds{45};

class DeclaredReceiver : public GapReceiver {
 public:
  // Three characters: less than the pause of any master before its next request.
  DeclaredReceiver(DeclaredDevice& device, const LineFormat& line, bool stream)
      : GapReceiver(line, stream ? kStreamGap : line.characters(3)), device_(device) {
    for (const Operation& operation : device.declaration().operations) {
      if (operation.unsolicited > Duration::zero()) unsolicited_.push_back({&operation, kLongAgo});
    }
  }

  void on_character(std::uint8_t character, Instant end, Reaction& reaction) override {
    heard(end, reaction);
    if (lost_) return;
    received_.push_back(character);
    const auto taken = device_.take(received_, end, reaction);
    if (taken == DeclaredDevice::Taken::kMore) return;
    ready(taken == DeclaredDevice::Taken::kNothing || reaction.response.empty());
  }

  [[nodiscard]] Instant sends_at() const override {
    Instant next = kNever;
    for (const Unsolicited& each : unsolicited_) next = std::min(next, each.next);
    return next;
  }
  void send(Instant now, Reaction& reaction) override {
    for (Unsolicited& each : unsolicited_) {
      if (each.next > now) continue;
      const Duration period = each.operation->unsolicited;
      if (each.next == kLongAgo) {
        each.next = now + device_.first_frame_after(period);
        continue;
      }
      each.next = now + period;
      append(reaction.response, device_.unsolicited(*each.operation, now));
    }
  }

 private:
  struct Unsolicited {
    const Operation* operation = nullptr;
    Instant next;
  };
  DeclaredDevice& device_;
  std::vector<Unsolicited> unsolicited_;
};

std::vector<ItemArea> areas_of(const declared::Declaration& declaration) {
  std::vector<ItemArea> areas;
  for (const DeclaredArea& area : declaration.areas)
    areas.push_back({area.name, area.item_bits, area.items});
  return areas;
}

std::uint32_t items_in(const Field& value) {
  if (value.scaled()) return declared::kScaledCharacters / 2;
  if (value.text_size != 0) return (value.text_size + 1u) / 2;
  return value.bits <= 16 ? 1 : value.bits <= 32 ? 2 : 4;
}

bool has_address(const declared::Frame& frame) {
  return std::ranges::any_of(frame.fields,
                             [](const Field& field) { return field.kind == FieldKind::kAddress; });
}

std::optional<std::uint32_t> number(std::string_view digits, const DeclaredArea& area) {
  const bool channels = area.base == declared::kChannelBase;
  auto number = address_number(digits, channels ? 10 : area.base);
  if (channels && number && *number % 100 > 15) return std::nullopt;
  if (channels && number) number = *number / 100 * 16 + *number % 100;
  if (!number || *number < area.origin || *number - area.origin >= area.items) return std::nullopt;
  return static_cast<std::uint32_t>(*number - area.origin);
}

}  // namespace

std::vector<std::string_view> declared_area_names(const declared::Declaration& declaration) {
  std::vector<std::string_view> names;
  for (const DeclaredArea& area : declaration.areas) names.push_back(area.name);
  return names;
}

std::uint8_t declared_code(const declared::Declaration& declaration, std::uint8_t code) {
  const auto& codes = declaration.codes;
  return codes.empty() || codes.contains(code) ? code
                                               : static_cast<std::uint8_t>(codes.begin()->first);
}

DeclaredDevice::DeclaredDevice(const DeviceSetup& setup)
    : MemoryDevice({areas_of(*setup.spec.declaration.value), setup}),
      declaration_(setup.spec.declaration.value),
      address_(*device_address(*declaration_, setup.spec.link)),
      line_(setup.line),
      stream_(setup.stream),
      start_(setup.start),
      form_(setup.form) {}

std::unique_ptr<Receiver> DeclaredDevice::open_receiver() {
  return std::make_unique<DeclaredReceiver>(*this, line_, stream_);
}

DeclaredDevice::Taken DeclaredDevice::take(ByteView bytes, Instant now, Reaction& reaction) {
  bool more = false;
  std::vector<const Operation*> rounds;
  for (const Operation& round : declaration_->login) rounds.push_back(&round);
  for (const Operation& operation : declaration_->operations) {
    for (const Operation& round : operation.before) rounds.push_back(&round);
  }
  for (const Operation* round : rounds) {
    if (auto greeting = greet(*round, bytes, more)) {
      reaction.response = std::move(*greeting);
      return Taken::kDone;
    }
  }
  std::optional<std::pair<const Operation*, DeclaredText>> outside;  // its area has no such items
  for (const Operation& operation : declaration_->operations) {
    if (operation.unsolicited > Duration::zero()) continue;
    DeclaredMatch received = on_request(*declaration_, operation, bytes, address_.text);
    more = more || received.fit == DeclaredMatch::Fit::kMore;
    if (received.fit != DeclaredMatch::Fit::kWhole || received.contradicts) continue;
    if (received.bad_check) {
      ++statistics_.bad_frames;
      continue;
    }
    if (has_address(operation.request) &&
        (received.text.address != address_.number || received.text.name != address_.text))
      return Taken::kDone;
    received.text.address = address_.number;
    received.text.name = address_.text;
    const DeclaredArea& area = declaration_->areas[operation.area];
    if (!area.record && (received.text.first >= area.items ||
                         received.text.count > area.items - received.text.first)) {
      if (!outside) outside.emplace(&operation, std::move(received.text));
      continue;
    }
    reaction.baud = operation.response_baud(received.text.rate);
    reaction.response = execute(operation, std::move(received.text), now);
    return Taken::kDone;
  }
  if (outside) {
    reaction.response = execute(*outside->first, std::move(outside->second), now);
    return Taken::kDone;
  }
  return more && bytes.size() < declared::kMaxFrame ? Taken::kMore : Taken::kNothing;
}

std::optional<Bytes> DeclaredDevice::greet(const Operation& round, ByteView bytes,
                                           bool& more) const {
  DeclaredMatch received = on_request(*declaration_, round, bytes, address_.text);
  more = more || received.fit == DeclaredMatch::Fit::kMore;
  if (received.fit != DeclaredMatch::Fit::kWhole || received.contradicts || received.bad_check)
    return std::nullopt;
  const bool mine = !has_address(round.request) || (received.text.address == address_.number &&
                                                    received.text.name == address_.text);
  received.text.address = address_.number;
  received.text.name = address_.text;
  return mine ? say(round.response, 16, received.text) : Bytes{};
}

std::uint8_t DeclaredDevice::refusal(const Operation& operation, const DeclaredText& text) const {
  const DeclaredArea& area = declaration_->areas[operation.area];
  const std::uint8_t missing = declared_code(*declaration_, kAddressCode);
  if (!area.record) {
    const bool far = text.first > UINT32_MAX / 2 || text.count > UINT32_MAX / 2;
    return far ? missing
               : memory_.refusal(operation.area, static_cast<std::uint32_t>(text.first),
                                 static_cast<std::uint32_t>(text.count), missing);
  }
  const auto of_place = [&](const Field& field) {
    return memory_.refusal(operation.area, field.place, items_in(field), missing);
  };
  for (const auto& [field, value] : text.numbers) {
    if (const std::uint8_t code = of_place(*field)) return code;
  }
  for (const auto& [field, value] : text.texts) {
    if (const std::uint8_t code = of_place(*field)) return code;
  }
  return operation.write ? 0 : memory_.refusal(operation.area, 0, area.items, 0);
}

Bytes DeclaredDevice::refuse(const Operation& operation, DeclaredText text, std::uint8_t code) {
  ++statistics_.exceptions[code];
  if (declaration_->refusals.empty()) return {};
  const declared::Frame& refused = declaration_->refusals[code % declaration_->refusals.size()];
  text.error = code;
  ++statistics_.responses;
  return say(refused, declaration_->areas[operation.area].item_bits, text);
}

Bytes DeclaredDevice::execute(const Operation& operation, DeclaredText text, Instant now) {
  ++statistics_.requests[operation.name];
  if (const std::uint8_t code = refusal(operation, text); code != 0)
    return refuse(operation, std::move(text), code);
  if (declaration_->areas[operation.area].trigger) text.items = {1};
  if (operation.write) store(operation, text);
  fill(operation, now, text);
  ++statistics_.responses;
  return say(form(operation, now), declaration_->areas[operation.area].item_bits, text);
}

const declared::Frame& DeclaredDevice::form(const Operation& operation, Instant now) const {
  return operation.form(form_ ? *form_ : static_cast<std::size_t>((now - start_) / kFormTime));
}

Bytes DeclaredDevice::unsolicited(const Operation& operation, Instant now) {
  ++statistics_.responses;
  DeclaredText text;
  text.address = address_.number;
  text.name = address_.text;
  text.command = operation.command;
  fill(operation, now, text);
  return say(operation.response, declaration_->areas[operation.area].item_bits, text);
}

void DeclaredDevice::store(const Operation& operation, const DeclaredText& text) {
  for (std::size_t i = 0; i < text.items.size(); ++i) {
    memory_.write(operation.area, static_cast<std::uint32_t>(text.first + i), text.items[i],
                  statistics_);
  }
  for (const auto& [field, value] : text.numbers) {
    const bool negative = field->is_signed && (value >> (field->bits - 1) & 1u) != 0;
    const std::uint64_t whole =
        negative && field->bits < 64 ? value | UINT64_MAX << field->bits : value;
    const std::uint32_t items = items_in(*field);
    for (std::uint32_t i = 0; i < items; ++i) {
      memory_.write(operation.area, field->place + i, whole >> 16 * (items - 1 - i) & 0xFFFFu,
                    statistics_);
    }
  }
  for (const auto& [field, value] : text.texts) {
    for (std::uint32_t i = 0; i < items_in(*field); ++i) {
      const auto at = [&written = value](std::size_t place) {
        return place < written.size() ? static_cast<std::uint8_t>(written[place]) : 0u;
      };
      memory_.write(operation.area, field->place + i, at(2 * i) << 8 | at(2 * i + 1), statistics_);
    }
  }
  ++statistics_.write_requests;
}

void DeclaredDevice::fill(const Operation& operation, Instant now, DeclaredText& text) const {
  text.items.clear();
  if (!declaration_->areas[operation.area].record) {
    for (std::uint64_t i = 0; i < text.count; ++i) {
      text.items.push_back(
          memory_.read(operation.area, static_cast<std::uint32_t>(text.first + i), now));
    }
    return;
  }
  for (const Field& field : form(operation, now).fields) {
    if (field.kind != FieldKind::kValue) continue;
    std::uint64_t number = 0;
    std::string characters;
    for (std::uint32_t i = 0; i < items_in(field); ++i) {
      const std::uint64_t item = memory_.read(operation.area, field.place + i, now);
      number = number << 16 | item;
      characters += {static_cast<char>(item >> 8), static_cast<char>(item & 0xFF)};
    }
    if (!field.scaled())
      characters.resize(std::min<std::size_t>(characters.size(), field.text_size));
    if (field.variable || field.scaled())
      characters.resize(std::min(characters.find('\0'), characters.size()));
    text.numbers[&field] = number;
    text.texts[&field] = characters;
  }
}

std::optional<ItemAddress> DeclaredDevice::parse_address(std::string_view at) const {
  constexpr std::uint64_t kNone = UINT64_MAX;
  const std::size_t dot = at.rfind('.');
  const std::uint64_t bit =
      dot == std::string_view::npos ? kNone : address_number(at.substr(dot + 1)).value_or(kNone);
  // Tries names of record values first, then numbers with a prefix.
  for (std::size_t i = 0; i < declaration_->areas.size(); ++i) {
    for (const declared::Place& place : declaration_->areas[i].places) {
      if (at == place.name) return ItemAddress{i, place.first, {}};
      if (bit == kNone || at.substr(0, dot) != place.name || bit >= place.bits) continue;
      return ItemAddress{i, place.first + place.items - 1 - static_cast<std::uint32_t>(bit / 16),
                         static_cast<std::uint8_t>(bit % 16)};
    }
  }
  for (std::size_t i = 0; i < declaration_->areas.size(); ++i) {
    const DeclaredArea& area = declaration_->areas[i];
    if (area.trigger && at == area.name) return ItemAddress{i, 0, {}};
    if (area.record || area.trigger || !at.starts_with(area.prefix)) continue;
    const std::string_view rest = at.substr(area.prefix.size());
    if (const auto item = number(rest, area)) return ItemAddress{i, *item, {}};
    if (bit >= area.item_bits || area.item_bits == 1) continue;
    if (const auto item = number(rest.substr(0, rest.rfind('.')), area))
      return ItemAddress{i, *item, static_cast<std::uint8_t>(bit)};
  }
  return std::nullopt;
}

tl::expected<std::unique_ptr<SimDevice>, std::string> make_declared_device(
    const DeviceSetup& setup) {
  const declared::Declaration& declaration = *setup.spec.declaration.value;
  if (const auto address = device_address(declaration, setup.spec.link); !address)
    return tl::unexpected(fmt::format("{}: {}", setup.spec.name, address.error().what));
  auto device = std::make_unique<DeclaredDevice>(setup);
  const auto parse = [&](std::string_view at) { return device->parse_address(at); };
  if (auto added = device->memory().add_channels(setup, parse); !added)
    return tl::unexpected(added.error());
  return device;
}

}  // namespace fieldcast::sim
