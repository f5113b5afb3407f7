#include "tools/station/settings/origin_check.hpp"

#include <algorithm>
#include <charconv>

namespace fieldcast::web {
namespace {

constexpr std::size_t kMaxHostBytes = 255;

std::string lower(std::string_view text) {
  std::string out(text);
  for (char& c : out) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return out;
}

std::size_t port_of(std::string_view host) {
  const std::size_t bracket = host.rfind(']');
  return host.find(':', bracket == host.npos ? 0 : bracket);
}

bool is_port(std::string_view text) {
  unsigned port = 0;
  const auto end = text.data() + text.size();
  return std::from_chars(text.data(), end, port).ptr == end && port > 0 && port < 65536;
}

bool is_letter_of_a_name(char c) {
  return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '-' ||
         c == '.' || c == '_';
}

bool is_letter_of_v6(char c) {
  return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f') || (c >= 'A' && c <= 'F') || c == ':' ||
         c == '.';
}

}  // namespace

HostList::HostList(const ListenSpec& listen, const std::vector<std::string>& names, bool tls) {
  const std::string port = ":" + std::to_string(listen.port);
  const bool usual = listen.port == (tls ? 443 : 80);
  const auto add = [&](const std::string& name) {
    hosts_.push_back(name + port);
    if (usual) hosts_.push_back(name);
  };
  for (const char* name : {"localhost", "127.0.0.1", "[::1]"}) add(name);
  const bool v6 = listen.host.find(':') != std::string::npos;
  if (listen.host != "0.0.0.0" && listen.host != "::")
    add(lower(v6 ? '[' + listen.host + ']' : listen.host));
  for (const std::string& name : names) {
    hosts_.push_back(lower(name));
    if (port_of(name) == std::string::npos) hosts_.push_back(lower(name) + port);
  }
}

bool HostList::serves(std::string_view host) const {
  return host.size() <= kMaxHostBytes && std::ranges::find(hosts_, lower(host)) != hosts_.end();
}

bool same_origin(std::string_view origin, std::string_view host, bool tls) {
  const std::string_view scheme = tls ? "https://" : "http://";
  if (host.empty() || !origin.starts_with(scheme)) return false;
  return lower(origin.substr(scheme.size())) == lower(host);
}

bool is_host_name(std::string_view text) {
  const std::size_t colon = port_of(text);
  if (colon != text.npos && !is_port(text.substr(colon + 1))) return false;
  std::string_view name = text.substr(0, colon);
  if (name.empty() || name.size() > kMaxHostBytes) return false;
  if (!name.starts_with('[')) return std::ranges::all_of(name, is_letter_of_a_name);
  if (name.size() < 4 || !name.ends_with(']')) return false;
  name = name.substr(1, name.size() - 2);
  return std::ranges::all_of(name, is_letter_of_v6);
}

}  // namespace fieldcast::web
