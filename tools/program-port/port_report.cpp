#include "tools/program-port/port_report.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <nlohmann/json.hpp>

#include "bridge/log/line_writer.hpp"
#include "core/base/printable.hpp"

namespace fieldcast::port {
namespace {

using Json = nlohmann::ordered_json;

// The port serves its program also while nobody reads its standard output.
LineWriter& output() {
  static auto& lines = *new LineWriter(STDOUT_FILENO, [](std::uint64_t lost) {
    return fmt::format("({} lines are missing here)\n", lost);
  });
  return lines;
}

// What the bridge says is text from outside.
void print(const std::string& line) { output().put(printable(line) + '\n'); }

void print(const Json& line) { print(line.dump(-1, ' ', false, Json::error_handler_t::replace)); }

constexpr Duration kLastWords = std::chrono::milliseconds{300};

std::string rate_text(double bytes_per_second) {
  char text[64];
  std::snprintf(text, sizeof text, "%.1f kB/s", bytes_per_second / 1000);
  return text;
}

}  // namespace

PortReport::~PortReport() { (void)output().flush(kLastWords); }

void PortReport::state(const std::string& state, const std::string& text) const {
  if (json_)
    return print(Json{{"device", device_}, {"link", link_}, {"state", state}, {"text", text}});
  print(fmt::format("{}: {}", device_, text));
}

void PortReport::dropped(const std::string& text) const {
  if (json_) return print(Json{{"device", device_}, {"dropped", text}});
  print(fmt::format("{}: {}", device_, text));
}

void PortReport::line(std::uint32_t baud, unsigned stop_bits) const {
  if (json_) return print(Json{{"device", device_}, {"baud", baud}, {"stop_bits", stop_bits}});
  print(fmt::format("{}: the program sets {} baud, {} stop bits", device_, baud, stop_bits));
}

void PortReport::traffic(std::uint64_t sent, std::uint64_t received, Instant now, bool last) {
  if (!last && sent == sent_ && received == received_) return void(at_ = now);
  const Instant from = last ? since_ : at_;
  const double seconds = std::max(to_seconds(now - from), 1e-3);
  const double out = static_cast<double>(last ? sent : sent - sent_) / seconds;
  const double in = static_cast<double>(last ? received : received - received_) / seconds;
  at_ = now;
  sent_ = sent;
  received_ = received;
  if (json_) {
    return print(Json{{"device", device_},
                      {"bytes_to_device", sent},
                      {"bytes_from_device", received},
                      {"rate_to_device", out},
                      {"rate_from_device", in},
                      {"seconds", seconds}});
  }
  print(fmt::format("{}: {} bytes sent ({}), {} received ({}){}", device_, sent, rate_text(out),
                    received, rate_text(in), last ? fmt::format(", in {:f} s", seconds) : ""));
}

}  // namespace fieldcast::port
