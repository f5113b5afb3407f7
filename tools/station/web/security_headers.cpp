#include "tools/station/web/security_headers.hpp"

#include <algorithm>

namespace fieldcast::web {
namespace {

// Only the station's own files; only lit-html may create markup from text.
constexpr std::string_view kPolicy =
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; "
    "connect-src 'self'; font-src 'self'; manifest-src 'self'; base-uri 'none'; "
    "form-action 'none'; require-trusted-types-for 'script'; trusted-types lit-html; "
    "frame-ancestors ";

}  // namespace

SecurityHeaders::SecurityHeaders(bool tls, const std::vector<std::string>& embed)
    : tls_(tls), policy_(std::string(kPolicy) + "'none'"), embed_policy_(kPolicy) {
  embed_policy_ += embed.empty() ? "'none'" : "'self'";
  for (const std::string& site : embed) embed_policy_ += ' ' + site;
}

void SecurityHeaders::add_to(HttpResponse& response, const std::string& path) const {
  const auto add = [&](const char* name, const std::string& value) {
    const auto known = std::ranges::find(response.headers, name, &TextPairs::value_type::first);
    if (known == response.headers.end()) response.headers.emplace_back(name, value);
  };
  const bool embedded = path == "/embed" || path.starts_with("/embed/");
  add("content-security-policy", embedded ? embed_policy_ : policy_);
  add("x-content-type-options", "nosniff");
  add("referrer-policy", "no-referrer");
  add("cross-origin-opener-policy", "same-origin");
  add("cross-origin-resource-policy", "same-origin");
  add("permissions-policy", "camera=(), geolocation=(), microphone=()");
  add("cache-control", "no-store");
  if (tls_) add("strict-transport-security", "max-age=31536000");
}

}  // namespace fieldcast::web
