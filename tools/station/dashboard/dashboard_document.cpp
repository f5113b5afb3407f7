#include "tools/station/dashboard/dashboard_document.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "core/base/message_text.hpp"
#include "tools/station/dashboard/document_check.hpp"

namespace fieldcast::web {

namespace {

using Json = nlohmann::json;

tl::unexpected<DashboardFaults> refused(std::string place, std::string what, std::string allowed) {
  return tl::make_unexpected(
      DashboardFaults{{std::move(place), std::move(what), std::move(allowed)}});
}

std::string line_of(std::string_view text, std::size_t byte) {
  const std::string_view before = text.substr(0, std::min(byte == 0 ? 0 : byte - 1, text.size()));
  const auto lines = std::ranges::count(before, '\n');
  const std::size_t start = before.rfind('\n') + 1;  // npos + 1 is 0
  return fmt::format("line {}, column {}", lines + 1, before.size() - start + 1);
}

// Watches the parser for what JSON itself allows.
struct Watch {
  bool operator()(int depth, Json::parse_event_t event, const Json& value) {
    using Event = Json::parse_event_t;
    if (depth > kMaxDashboardDepth) too_deep = true;
    if (event == Event::object_start) keys.emplace_back();
    if (event == Event::object_end) keys.pop_back();
    if (event == Event::key && !keys.back().insert(value.get<std::string>()).second)
      repeated = value.get<std::string>();
    return !too_deep;
  }
  bool too_deep = false;
  std::string repeated;
  std::vector<std::set<std::string>> keys;
};

tl::expected<Json, DashboardFaults> parsed(std::string_view text) {
  if (text.size() > kMaxDashboardBytes)
    return refused("document", fmt::format("the text has {} bytes", text.size()),
                   fmt::format("at most {} bytes", kMaxDashboardBytes));
  Watch watch;
  try {
    Json document = Json::parse(text, std::ref(watch));
    if (watch.too_deep)
      return refused("document", "brackets are nested too deep",
                     fmt::format("at most {} levels", kMaxDashboardDepth));
    if (!watch.repeated.empty())
      return refused("document",
                     fmt::format("'{}' is written twice", printable(watch.repeated, 60)),
                     "each property once");
    if (!document.is_object()) return refused("document", "the text is not an object", "{...}");
    return document;
  } catch (const Json::parse_error& error) {
    return refused(line_of(text, error.byte), "the text is not JSON here", "JSON (RFC 8259)");
  } catch (const Json::exception&) {
    return refused("document", "a number is too large", "JSON with numbers of 64 bits");
  }
}

}  // namespace

bool is_dashboard_name(std::string_view text) {
  const auto plain = [](char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9'); };
  return !text.empty() && text.size() <= 64 && plain(text.front()) &&
         std::ranges::all_of(text, [&](char c) { return plain(c) || c == '-'; });
}

tl::expected<DashboardHead, DashboardFaults> check_dashboard(std::string_view text) {
  static const Json kFormat = Json::parse(dashboard_format());
  const auto document = parsed(text);
  if (!document) return tl::make_unexpected(document.error());
  DocumentCheck check(kFormat);
  check.check_document(*document);
  DashboardFaults faults = check.take_faults();
  if (!faults.empty()) return tl::make_unexpected(std::move(faults));
  return DashboardHead{document->at("name"), document->at("title")};
}

}  // namespace fieldcast::web
