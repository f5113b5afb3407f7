#include "bridge/dds/guard/shared_guard.hpp"

#include <atomic>
#include <string>

#include "bridge/dds/library/library.hpp"

namespace fieldcast {
namespace {

std::array<std::atomic<std::uint64_t>, kRtpsFaults> refused{};

bool is_power_of_ten(std::uint64_t count) {
  while (count % 10 == 0) count /= 10;
  return count == 1;
}

// An IPv4 address is at the end of a locator's 16 bytes.
std::string text_of(const DatagramGuard::Address& from) {
  std::string text;
  for (std::size_t i = from.size() - 4; i < from.size(); ++i)
    text += (text.empty() ? "" : ".") + std::to_string(from[i]);
  return text;
}

}  // namespace

RtpsFaultCounts refused_datagrams() {
  RtpsFaultCounts counts{};
  for (std::size_t i = 0; i < kRtpsFaults; ++i) counts[i] = refused[i];
  return counts;
}

DatagramGuard::Verdict SharedGuard::check(std::span<const std::uint8_t> datagram,
                                          const DatagramGuard::Address& from,
                                          DatagramGuard::Bytes& scratch) {
  const Instant now{std::chrono::steady_clock::now().time_since_epoch()};
  DatagramGuard::Verdict verdict = [&] {
    const std::lock_guard lock(mutex_);
    return guard_.check(datagram, from, now, scratch);
  }();
  if (!verdict.fault) return verdict;
  const std::uint64_t count = ++refused[static_cast<std::size_t>(*verdict.fault)];
  if (is_power_of_ten(count)) {
    say_security(false, "refused a datagram of " + text_of(from) + " before DDS reads it: " +
                            std::string(to_text(*verdict.fault)) + ", " + std::to_string(count) +
                            " so far; docs/security.md explains the causes");
  }
  return verdict;
}

}  // namespace fieldcast
