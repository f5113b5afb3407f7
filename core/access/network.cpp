#include "core/access/network.hpp"

#include <algorithm>
#include <charconv>
#include <string>

namespace fieldcast::access {
namespace {

using Address = std::array<std::uint8_t, 16>;
constexpr unsigned kBits = 128, kBitsBeforeIpv4 = 96;
constexpr std::size_t kGroups = 8;
constexpr Address kMapped{0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xFF, 0xFF};  // ::ffff:0:0/96

std::optional<unsigned> number_from(std::string_view text, int base, unsigned most) {
  unsigned number = 0;
  const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), number, base);
  if (fault != std::errc{} || end != text.data() + text.size() || number > most) return {};
  return number;
}

std::string_view take_until(std::string_view& text, char separator) {
  const auto at = text.find(separator);
  const std::string_view part = text.substr(0, at);
  text = at == text.npos ? std::string_view{} : text.substr(at + 1);
  return part;
}

std::optional<std::array<std::uint8_t, 4>> ipv4_from(std::string_view text) {
  if (std::ranges::count(text, '.') != 3) return {};
  std::array<std::uint8_t, 4> bytes{};
  for (std::uint8_t& byte : bytes) {
    const std::string_view part = take_until(text, '.');
    // Some programs read "010" as 8, others as 10.
    if (part.size() > 1 && part.front() == '0') return {};
    const auto number = number_from(part, 10, 255);
    if (!number) return {};
    byte = static_cast<std::uint8_t>(*number);
  }
  return bytes;
}

bool read_groups(std::string_view text, Address& address, std::size_t& count) {
  while (!text.empty()) {
    const bool last = text.find(':') == text.npos;
    if (!last && text.back() == ':') return false;
    const std::string_view part = take_until(text, ':');
    if (last && part.find('.') != part.npos) {
      const auto ipv4 = ipv4_from(part);
      if (!ipv4 || count + 2 > kGroups) return false;
      std::ranges::copy(*ipv4, address.begin() + static_cast<std::ptrdiff_t>(2 * count));
      count += 2;
      return true;
    }
    const auto group = part.size() > 4 ? std::nullopt : number_from(part, 16, 0xFFFF);
    if (!group || count == kGroups) return false;
    address[2 * count] = static_cast<std::uint8_t>(*group >> 8);
    address[2 * count + 1] = static_cast<std::uint8_t>(*group);
    ++count;
  }
  return true;
}

std::optional<Address> ipv6_from(std::string_view text) {
  Address front{}, back{};
  std::size_t before = 0, after = 0;
  const auto gap = text.find("::");
  if (gap == text.npos) {
    if (!read_groups(text, front, before) || before != kGroups) return {};
    return front;
  }
  if (!read_groups(text.substr(0, gap), front, before) ||
      !read_groups(text.substr(gap + 2), back, after) || before + after >= kGroups)
    return {};
  const auto size = static_cast<std::ptrdiff_t>(2 * after);
  std::copy_n(back.begin(), size, front.end() - size);
  return front;
}

std::string_view without_brackets(std::string_view text) {
  return text.starts_with('[') && text.ends_with(']') ? text.substr(1, text.size() - 2) : text;
}

std::optional<Address> address_from(std::string_view text) {
  text = without_brackets(text);
  if (const auto ipv4 = ipv4_from(text)) {
    Address address = kMapped;
    std::ranges::copy(*ipv4, address.begin() + 12);
    return address;
  }
  return ipv6_from(text.substr(0, text.find('%')));
}

bool agree(const Address& a, const Address& b, unsigned bits) {
  for (unsigned bit = 0; bit < bits; ++bit) {
    if (((a[bit / 8] ^ b[bit / 8]) & (0x80U >> (bit % 8))) != 0) return false;
  }
  return true;
}

}  // namespace

std::optional<Network> Network::parse(std::string_view text) {
  const bool has_prefix = text.find('/') != text.npos;
  const std::string_view host = take_until(text, '/');
  const auto address = address_from(host);
  if (!address || host.starts_with('[') || host.find('%') != host.npos) return {};
  Network network;
  network.address_ = *address;
  network.prefix_ = kBits;
  if (!has_prefix) return network;
  const unsigned before = host.find(':') == host.npos ? kBitsBeforeIpv4 : 0;
  const auto prefix = text.size() > 3 ? std::nullopt : number_from(text, 10, kBits - before);
  if (!prefix) return {};
  network.prefix_ = before + *prefix;
  for (unsigned bit = network.prefix_; bit < kBits; ++bit) {
    if ((network.address_[bit / 8] & (0x80U >> (bit % 8))) != 0) return {};
  }
  return network;
}

bool Network::contains(std::string_view address) const {
  const auto parsed = address_from(address);
  return parsed && agree(*parsed, address_, prefix_);
}

std::string address_group(std::string_view address) {
  const auto parsed = address_from(address);
  address = without_brackets(address);
  if (!parsed) return std::string(address.substr(0, address.find('%')));
  std::string group;
  const auto append = [&group](unsigned number, int base) {
    std::array<char, 4> digits{};
    group.append(digits.data(),
                 std::to_chars(digits.data(), digits.data() + digits.size(), number, base).ptr);
  };
  if (agree(*parsed, kMapped, kBitsBeforeIpv4)) {
    for (std::size_t i = 12; i < parsed->size(); ++i) {
      if (i > 12) group += '.';
      append((*parsed)[i], 10);
    }
    return group;
  }
  for (std::size_t i = 0; i < 8; i += 2) {
    append(256U * (*parsed)[i] + (*parsed)[i + 1], 16);
    group += ':';
  }
  return group + ":/64";
}

}  // namespace fieldcast::access
