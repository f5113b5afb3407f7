#include "core/protocol/declared/declaration.hpp"

#include <algorithm>
#include <charconv>

#include "core/base/message_text.hpp"
#include "core/protocol/option_reader.hpp"

namespace fieldcast::declared {

namespace {

std::string spelt(std::uint32_t number, int base) {
  if (base == kChannelBase) number = number / 16 * 100 + number % 16, base = 10;
  char text[16];
  const auto [end, error] = std::to_chars(text, text + sizeof text, number, base);
  std::transform(text, end, text, [](char c) {
    return c >= 'a' && c <= 'f' ? static_cast<char>(c - 'a' + 'A') : c;
  });
  return {text, end};
}

// What the field is when it is sent, whatever it is called.
Field as_sent(Field field) {
  field.name.clear();
  if (field.kind == FieldKind::kError) field.kind = FieldKind::kConstant;
  return field;
}

bool can_have_same_bytes(const Field& a, const Field& b) {
  if (a.kind == FieldKind::kUnused || b.kind == FieldKind::kUnused)
    return a.bits == b.bits && a.opens == b.opens && a.word == b.word && a.text_size == b.text_size;
  return as_sent(a) == as_sent(b);
}

std::string allowed(const Declaration& declaration) {
  std::string text;
  for (const DeclaredArea& area : declaration.areas) {
    if (area.record) {
      for (const Place& place : area.places) text += (text.empty() ? "" : ", ") + place.name;
    } else if (area.trigger) {
      text += (text.empty() ? "" : ", ") + area.name;
    } else {
      text += (text.empty() ? "" : ", ") + area.prefix + "N with N " +
              spelt(area.origin, area.base) + ".." + spelt(area.origin + area.items - 1, area.base);
    }
  }
  return text + "; a bit as .BIT behind it";
}

class Parser {
 public:
  Parser(const Declaration& declaration, std::string_view at, bool guesses = true)
      : declaration_(declaration), at_(at), guesses_(guesses) {}

  ParsedOrFault run() const {
    for (std::size_t i = 0; i < declaration_.areas.size(); ++i) {
      const DeclaredArea& area = declaration_.areas[i];
      const auto index = static_cast<AreaIndex>(i);
      if (area.trigger && at_ == area.name) return ParsedAddress{.area = index, .width_bits = 1};
      for (const Place& place : area.places) {
        if (at_.starts_with(place.name) &&
            (at_.size() == place.name.size() || at_[place.name.size()] == '.'))
          if (auto found = in_place(index, place, at_.substr(place.name.size()))) return *found;
      }
    }
    std::optional<ParsedOrFault> outside;  // areas with the same prefix have different numbers
    for (std::size_t i = 0; i < declaration_.areas.size(); ++i) {
      const DeclaredArea& area = declaration_.areas[i];
      if (area.record || area.trigger || !at_.starts_with(area.prefix) ||
          at_.size() <= area.prefix.size() || !whole_begins(area))
        continue;
      auto found = numbered(static_cast<AreaIndex>(i), area, at_.substr(area.prefix.size()));
      if (found) return found;
      if (!outside) outside = std::move(found);
    }
    return outside ? *outside : unknown();
  }

 private:
  bool whole_begins(const DeclaredArea& area) const {
    const auto digits = at_.substr(area.prefix.size());
    return area_number(area, digits.substr(0, digits.find('.'))).has_value();
  }
  ParsedOrFault fault(std::string what, std::string suggestion = {}) const {
    return AddressFaults{allowed(declaration_)}(std::move(what), std::move(suggestion));
  }

  // Leaves a longer place name, such as "input.2" against "input", to the other places.
  std::optional<ParsedOrFault> in_place(AreaIndex area, const Place& place,
                                        std::string_view rest) const {
    ParsedAddress address{.area = area, .first = place.first};
    address.text_characters = place.characters;
    address.text_number = place.text_number;
    if (place.bits == 0) return rest.empty() ? std::optional<ParsedOrFault>(address) : std::nullopt;
    address.width_bits = 16u * place.items;
    address.value_bits = place.bits;
    address.value_signed = place.is_signed;
    if (rest.empty()) return address;
    const auto bit = whole_number(rest.substr(1), 10);
    if (!bit) return std::nullopt;
    if (*bit >= place.bits) {
      return fault("bit " + std::to_string(*bit) + " is beyond " + in_quotes(place.name) +
                       ", which has " + std::to_string(place.bits),
                   place.name + "." + std::to_string(place.bits - 1));
    }
    address.first += place.items - 1 - *bit / 16;  // the last item holds the lowest bits
    address.bit = static_cast<std::uint8_t>(*bit % 16);
    address.width_bits = 1;
    return address;
  }

  ParsedOrFault numbered(AreaIndex index, const DeclaredArea& area, std::string_view rest) const {
    const auto dot = rest.find('.');
    const auto number = area_number(area, rest.substr(0, dot));
    const std::uint32_t last = area.origin + area.items - 1;
    if (!number || *number < area.origin || *number > last) {
      return fault(in_quotes(at_) + " is outside " + area.name,
                   area.prefix + spelt(number && *number > last ? last : area.origin, area.base));
    }
    ParsedAddress address{.area = index, .first = *number - area.origin};
    if (area.item_bits == 1) address.width_bits = 1;
    if (dot == rest.npos) return address;
    const std::string without(at_.substr(0, area.prefix.size() + dot));
    if (area.item_bits == 1)
      return fault("a " + area.name + " is a bit itself and has no bits", without);
    if (!set_bit(address, whole_number(rest.substr(dot + 1)), area.item_bits)) {
      return fault("bit " + in_quotes(rest.substr(dot + 1)) + " is not 0.." +
                       std::to_string(area.item_bits - 1),
                   without + ".0");
    }
    return address;
  }

  ParsedOrFault unknown() const {
    const std::string what = in_quotes(at_) + " is no address";
    if (!guesses_) return fault(what);
    const auto digits = std::min(at_.find_first_of("0123456789."), at_.size());
    const std::string_view word = at_.substr(0, digits);
    std::vector<std::string_view> names;
    for (const DeclaredArea& area : declaration_.areas) {
      if (!area.record) names.push_back(area.trigger ? area.name : area.prefix);
      for (const Place& place : area.places) names.push_back(place.name);
    }
    const auto near = near_miss(word, names);
    if (near.empty()) return fault(what);
    // Tries the same number, then the first place of that name.
    for (const auto& guess : {std::string(near) + std::string(at_.substr(digits)),
                              std::string(near), std::string(near) + "0"}) {
      if (Parser(declaration_, guess, false).run()) return fault(what, guess);
    }
    return fault(what);
  }

  const Declaration& declaration_;
  const std::string_view at_;
  const bool guesses_;
};

}  // namespace

bool Operation::echoes() const {
  return write && request.escape == response.escape && request.escaped == response.escaped &&
         std::ranges::equal(request.fields, response.fields, can_have_same_bytes);
}

std::optional<std::uint32_t> area_number(const DeclaredArea& area, std::string_view digits) {
  const bool channels = area.base == kChannelBase;
  const auto number = whole_number(digits, channels ? 10 : area.base);
  if (!channels || !number || *number == UINT32_MAX) return number;
  if (*number % 100 > 15) return std::nullopt;
  return *number / 100 * 16 + *number % 100;
}

std::string item_text(const DeclaredArea& area, std::uint32_t item) {
  return area.prefix + spelt(area.origin + item, area.base);
}

tl::expected<DeviceAddress, OptionFault> device_address(const Declaration& declaration,
                                                        const DeviceLink& link) {
  const std::string text = address_text(link);
  const auto refuse = [&](std::string allowed) {
    return tl::unexpected(
        OptionFault{{},
                    "address " + in_quotes(text) + " is outside what " + declaration.name + " has",
                    std::move(allowed)});
  };
  if (declaration.address_characters != 0) {
    if (text.size() > declaration.address_characters)
      return refuse("1 to " + std::to_string(declaration.address_characters) + " characters");
    return DeviceAddress{0, text};
  }
  std::uint64_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{} || end != text.data() + text.size() ||
      number < declaration.lowest_address || number > declaration.highest_address) {
    return refuse(std::to_string(declaration.lowest_address) + ".." +
                  std::to_string(declaration.highest_address));
  }
  return DeviceAddress{number, {}};
}

ParsedOrFault parse_address(const Declaration& declaration, std::string_view at) {
  return Parser(declaration, at).run();
}

}  // namespace fieldcast::declared
