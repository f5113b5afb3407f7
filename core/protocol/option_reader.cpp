#include "core/protocol/option_reader.hpp"

#include <algorithm>
#include <charconv>

#include "core/base/message_text.hpp"

namespace fieldcast {

namespace {

std::string listed(std::span<const std::string_view> words) {
  std::string text;
  for (const std::string_view word : words) text += (text.empty() ? "" : ", ") + std::string(word);
  return text.empty() ? "no options" : text;
}

}  // namespace

OptionReader::OptionReader(const DeviceLink& link, const Traits& traits,
                           std::span<const std::string_view> names)
    : link_(link) {
  for (const auto& [name, value] : link.options) {
    if (std::ranges::find(names, name) != names.end()) continue;
    const std::string_view near = near_miss(name, names);
    std::string what = "option '" + name + "' is unknown to " + std::string(traits.name);
    if (!near.empty()) what += "; did you mean '" + std::string(near) + "'?";
    refuse(name, std::move(what), listed(names));
  }
  if (link.address < traits.lowest_address || link.address > traits.highest_address ||
      !link.long_address.empty()) {
    refuse(
        {},
        "address " + address_text(link) + " is outside what " + std::string(traits.name) + " has",
        std::to_string(traits.lowest_address) + ".." + std::to_string(traits.highest_address));
  }
}

const std::string* OptionReader::text_of(std::string_view name) const {
  const auto found = link_.options.find(std::string(name));
  return found == link_.options.end() ? nullptr : &found->second;
}

void OptionReader::refuse(std::string_view name, std::string what, std::string allowed) {
  if (!fault_) fault_ = OptionFault{std::string(name), std::move(what), std::move(allowed)};
}

bool OptionReader::flag(std::string_view name, bool otherwise) {
  return choice(name, {"false", "true"}, otherwise ? 1 : 0) == 1;
}

std::size_t OptionReader::choice(std::string_view name,
                                 std::initializer_list<std::string_view> choices,
                                 std::size_t otherwise) {
  const std::string* text = text_of(name);
  if (text == nullptr) return otherwise;
  const auto found = std::ranges::find(choices, *text);
  if (found != choices.end()) return static_cast<std::size_t>(found - choices.begin());
  const std::span<const std::string_view> words(choices.begin(), choices.size());
  const std::string_view near = near_miss(*text, words);
  refuse(name,
         "'" + *text + "' is no choice" +
             (near.empty() ? "" : "; did you mean '" + std::string(near) + "'?"),
         listed(words));
  return otherwise;
}

std::uint32_t OptionReader::number(std::string_view name, std::uint32_t lowest,
                                   std::uint32_t highest, std::uint32_t otherwise) {
  const std::string* text = text_of(name);
  if (text == nullptr) return otherwise;
  std::uint32_t value = 0;
  const auto [end, error] = std::from_chars(text->data(), text->data() + text->size(), value);
  if (error == std::errc{} && end == text->data() + text->size() && value >= lowest &&
      value <= highest)
    return value;
  refuse(name, "'" + *text + "' is no such number",
         std::to_string(lowest) + ".." + std::to_string(highest));
  return otherwise;
}

}  // namespace fieldcast
