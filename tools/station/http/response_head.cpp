#include "tools/station/http/response_head.hpp"

#include <fmt/format.h>

#include <array>
#include <chrono>

namespace fieldcast::web {
namespace {

constexpr std::pair<unsigned, std::string_view> kReasons[] = {
    {200, "OK"},
    {202, "Accepted"},
    {204, "No Content"},
    {304, "Not Modified"},
    {400, "Bad Request"},
    {401, "Unauthorized"},
    {403, "Forbidden"},
    {404, "Not Found"},
    {405, "Method Not Allowed"},
    {408, "Request Timeout"},
    {409, "Conflict"},
    {413, "Content Too Large"},
    {415, "Unsupported Media Type"},
    {421, "Misdirected Request"},
    {422, "Unprocessable Content"},
    {426, "Upgrade Required"},
    {429, "Too Many Requests"},
    {431, "Request Header Fields Too Large"},
    {500, "Internal Server Error"},
    {501, "Not Implemented"},
    {503, "Service Unavailable"},
    {504, "Gateway Timeout"},
};

bool one_line(std::string_view text) {
  for (const char c : text) {
    if (c == '\r' || c == '\n' || c == '\0') return false;
  }
  return true;
}

// "Sun, 06 Nov 1994 08:49:37 GMT"
std::string http_date(UtcTime at) {
  using namespace std::chrono;
  static constexpr std::array kDays{"Sun", "Mon", "Tue", "Wed", "Thu", "Fri", "Sat"};
  static constexpr std::array kMonths{"Jan", "Feb", "Mar", "Apr", "May", "Jun",
                                      "Jul", "Aug", "Sep", "Oct", "Nov", "Dec"};
  const sys_seconds second{floor<seconds>(nanoseconds{at.nanoseconds})};
  const auto day = floor<days>(second);
  const year_month_day date{day};
  const hh_mm_ss time{second - day};
  return fmt::format("{}, {:02} {} {} {:02}:{:02}:{:02} GMT", kDays[weekday{day}.c_encoding()],
                     static_cast<unsigned>(date.day()),
                     kMonths[static_cast<unsigned>(date.month()) - 1],
                     static_cast<int>(date.year()), time.hours().count(), time.minutes().count(),
                     time.seconds().count());
}

}  // namespace

std::string_view reason_of(unsigned status) {
  for (const auto& [code, reason] : kReasons) {
    if (code == status) return reason;
  }
  return "Other";
}

bool has_no_body(unsigned status) { return status == 204 || status == 304 || status < 200; }

std::string response_head(const HttpResponse& response, const HeadOptions& options) {
  std::string head = fmt::format("HTTP/1.1 {} {}\r\n", response.status, reason_of(response.status));
  const auto add = [&head](std::string_view name, std::string_view value) {
    if (one_line(name) && one_line(value)) head += fmt::format("{}: {}\r\n", name, value);
  };
  add("date", http_date(options.date));
  add("connection", options.keep_alive ? "keep-alive" : "close");
  if (!has_no_body(response.status)) {
    add("content-type", response.content_type);
    if (options.chunked) add("transfer-encoding", "chunked");
    if (options.length) add("content-length", std::to_string(*options.length));
  }
  for (const auto& [name, value] : response.headers) add(name, value);
  head += "\r\n";
  return head;
}

}  // namespace fieldcast::web
