#include "tools/station/api/base/exchange.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <nlohmann/json.hpp>

#include "bridge/http/http_message.hpp"
#include "core/base/duration_text.hpp"
#include "core/base/message_text.hpp"
#include "tools/cli/model/sample_text.hpp"

namespace fieldcast::web {

namespace {

constexpr std::size_t kShown = 80;  // bytes of a value in an error
constexpr Duration kLongest = std::chrono::hours{24 * 366};
constexpr std::string_view kTimes =
    "Unix milliseconds, or a time such as 2026-11-21T10:30Z, or 2h for two hours ago";

HttpResponse refused(std::string_view name, const std::string& given, std::string_view wanted) {
  return error_response(
      400, fmt::format("{}: '{}' cannot be used", name, printable(given.substr(0, kShown))),
      fmt::format("{} is {}", name, wanted));
}

template <class Number>
std::optional<Number> whole_number(std::string_view text) {
  Number number{};
  const auto read = std::from_chars(text.data(), text.data() + text.size(), number);
  if (text.empty() || read.ec != std::errc{} || read.ptr != text.data() + text.size())
    return std::nullopt;
  return number;
}

// Accepts a fraction of a millisecond, because JavaScript clocks have one.
std::optional<UtcTime> from_unix_ms(std::string_view text) {
  constexpr double kMost = 9'000'000'000'000;  // year 2255: its nanoseconds fit in 64 bits
  const auto ms = whole_number<double>(text);
  if (!ms || !(*ms >= 0 && *ms <= kMost)) return std::nullopt;
  const auto whole = static_cast<std::int64_t>(*ms);
  const double rest = *ms - static_cast<double>(whole);
  return UtcTime{whole * 1'000'000 + static_cast<std::int64_t>(rest * 1e6)};
}

}  // namespace

std::optional<HttpResponse> Parameters::fault(std::string_view may_repeat) const {
  std::vector<std::string_view> seen;
  for (const auto& [name, value] : request_.query) {
    if (std::ranges::find(known_, name) == known_.end()) {
      const std::string_view meant = near_miss(name, known_);
      return error_response(
          400, fmt::format("the parameter '{}' is unknown", printable(name.substr(0, kShown))),
          meant.empty() ? fmt::format("known here: {}", fmt::join(known_, ", "))
                        : fmt::format("did you mean {}?", meant));
    }
    if (name != may_repeat && std::ranges::find(seen, name) != seen.end())
      return error_response(400, fmt::format("the parameter '{}' came twice", name),
                            "give it once");
    seen.push_back(name);
  }
  return std::nullopt;
}

Checked<std::uint32_t> Parameters::number(std::string_view name, std::uint32_t least,
                                          std::uint32_t most, std::uint32_t missing) const {
  const auto text = request_.parameter(name);
  if (!text) return missing;
  const auto number = whole_number<std::uint32_t>(*text);
  if (number && *number >= least && *number <= most) return *number;
  return tl::make_unexpected(
      refused(name, *text, fmt::format("a whole number from {} to {}", least, most)));
}

Checked<Pattern> Parameters::pattern(std::string_view name) const {
  const auto text = request_.parameter(name);
  if (!text) return Pattern();
  auto pattern = Pattern::parse(*text);
  if (pattern) return *std::move(pattern);
  return tl::make_unexpected(
      refused(name, *text, "BUS/DEVICE/CHANNEL with * for any run of characters"));
}

Checked<bool> Parameters::chosen(std::string_view name, std::string_view no,
                                 std::string_view yes) const {
  const auto text = request_.parameter(name);
  if (!text || *text == no) return false;
  if (*text == yes) return true;
  return tl::make_unexpected(refused(name, *text, fmt::format("{} or {}", no, yes)));
}

Checked<std::optional<Duration>> Parameters::duration(std::string_view name, Duration least) const {
  const auto text = request_.parameter(name);
  if (!text) return std::nullopt;
  const auto duration = duration_from(*text);
  if (duration && *duration >= least && *duration <= kLongest) return duration;
  return tl::make_unexpected(
      refused(name, *text,
              fmt::format("a duration of {} to one year, such as 10s, 1min, 1h",
                          fieldcast::to_text(least))));
}

Checked<std::optional<UtcTime>> Parameters::time(std::string_view name, UtcTime now) const {
  const auto text = request_.parameter(name);
  if (!text) return std::nullopt;
  if (const auto by_number = from_unix_ms(*text)) return by_number;
  const auto time = cli::parse_time(*text, now);
  if (time && time->nanoseconds >= 0) return *time;
  return tl::make_unexpected(refused(name, *text, kTimes));
}

Checked<Parameters::Span> Parameters::span(UtcTime now, Duration length) const {
  const auto from = time("from", now);
  if (!from) return tl::make_unexpected(from.error());
  const auto to = time("to", now);
  if (!to) return tl::make_unexpected(to.error());
  const UtcTime end = to->value_or(now);
  const UtcTime begin =
      from->value_or(UtcTime{std::max<std::int64_t>(end.nanoseconds - length.count(), 0)});
  if (begin < end) return Span{begin, end};
  return tl::make_unexpected(error_response(400, "from is not before to",
                                            "give a from that is earlier; a missing to is now"));
}

Checked<std::vector<ChannelPath>> Parameters::channels(std::string_view name,
                                                       std::size_t most) const {
  const auto texts = request_.parameters(name);
  if (texts.empty() || texts.size() > most)
    return tl::make_unexpected(
        error_response(400, fmt::format("{} came {} times", name, texts.size()),
                       fmt::format("give {}=BUS/DEVICE/CHANNEL once to {} times", name, most)));
  std::vector<ChannelPath> paths;
  for (const std::string& text : texts) {
    auto path = ChannelPath::parse(text);
    if (!path) return tl::make_unexpected(refused(name, text, "BUS/DEVICE/CHANNEL"));
    if (std::ranges::find(paths, *path) != paths.end())
      return tl::make_unexpected(refused(name, text, "a channel that came only once"));
    paths.push_back(*std::move(path));
  }
  return paths;
}

std::optional<HttpResponse> unknown_member(const nlohmann::json& object,
                                           std::initializer_list<std::string_view> known) {
  for (const auto& [name, value] : object.items()) {
    if (std::find(known.begin(), known.end(), name) == known.end())
      return error_response(400, fmt::format("'{}' is unknown here", printable(name, 80)),
                            fmt::format("known: {}", fmt::join(known, ", ")));
  }
  return std::nullopt;
}

HttpResponse json_response(std::string json, bool compress) {
  HttpResponse response;
  if (compress && json.size() >= kWorthCompressing) {
    response.body = packed(json);
    response.headers.emplace_back("content-encoding", "gzip");
  } else {
    response.body = std::move(json);
  }
  return response;
}

HttpResponse no_store() {
  return error_response(404, "this station stores nothing",
                        "give it a store: 'store: { path: FILE }' in its configuration");
}

}  // namespace fieldcast::web
