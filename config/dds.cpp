#include "config/dds.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "config/keys/bridge_keys.hpp"
#include "config/limits.hpp"
#include "config/port.hpp"
#include "config/scalars.hpp"

namespace fieldcast::config {
namespace {

void read_interfaces(MapReader& map, DdsSpec& spec) {
  const Node* node = map.find("interfaces");
  if (node == nullptr) return;
  if (node->kind != Kind::kList || node->items.empty() || node->items.size() > kMaxInterfaces) {
    const bool count = node->kind == Kind::kList;
    map.faults().add(
        node->position,
        "interfaces is " + (count ? (node->items.empty() ? "empty" : "too long")
                                  : std::string(to_text(node->kind))),
        fmt::format("a list of 1 to {} IPv4 addresses", kMaxInterfaces),
        node->kind == Kind::kScalar && is_ipv4(node->text) ? '[' + node->text + ']' : "");
    return;
  }
  spec.interfaces.clear();
  for (const Node* item : node->items) {
    const std::string* text = scalar_of(*item, "interface", "an IPv4 address", map.faults());
    if (text == nullptr) continue;
    if (!is_ipv4(*text)) {
      const bool loopback = *text == "lo" || *text == "localhost";
      map.faults().add(item->position, fmt::format("interface '{}' is no IPv4 address", *text),
                       "the address of a network interface of this machine",
                       loopback ? "127.0.0.1" : "");
    }
    spec.interfaces.push_back(*text);
  }
}

constexpr int kServerPort = 11811;  // the usual one of a discovery server

void check_host_port(MapReader& map, const Position& position, std::string_view key,
                     const std::string& text, int usual_port) {
  if (host_port_from(text)) return;
  map.faults().add(position, fmt::format("{} '{}' names no host and port", key, text),
                   "HOST:PORT with a port 1 to 65535",
                   text.find(':') == text.npos ? fmt::format("{}:{}", text, usual_port) : "");
}

// A list of "HOST:PORT".
void read_hosts(MapReader& map, std::string_view key, std::size_t most, int usual_port,
                std::vector<std::string>& target) {
  const Node* node = map.find(key);
  if (node == nullptr) return;
  if (node->kind != Kind::kList || node->items.empty() || node->items.size() > most) {
    const bool list = node->kind == Kind::kList;
    map.faults().add(node->position,
                     fmt::format("{} is {}", key,
                                 list ? (node->items.empty() ? "empty" : "too long")
                                      : std::string(to_text(node->kind))),
                     fmt::format("a list of 1 to {} HOST:PORT", most),
                     node->kind == Kind::kScalar ? '[' + node->text + ']' : "");
    return;
  }
  for (const Node* item : node->items) {
    const std::string* text = scalar_of(*item, key, "HOST:PORT", map.faults());
    if (text == nullptr) continue;
    check_host_port(map, item->position, key, *text, usual_port);
    if (std::find(target.begin(), target.end(), *text) != target.end())
      map.faults().add(item->position, fmt::format("{} names '{}' twice", key, *text), "each once");
    target.push_back(*text);
  }
}

void read_servers(MapReader& map, DdsSpec& spec) {
  std::string one;
  if (map.read("discovery-server", one, TextRule{kMaxPath})) {
    check_host_port(map, map.position_of("discovery-server"), "discovery-server", one, kServerPort);
    spec.discovery_servers = {one};
  }
  std::vector<std::string> several;
  read_hosts(map, "discovery-servers", kMaxServers, kServerPort, several);
  if (several.empty()) return;
  if (!one.empty()) {
    map.faults().add(map.position_of("discovery-server"),
                     "'discovery-server' and 'discovery-servers' in one map", "one of them");
  }
  spec.discovery_servers = std::move(several);
}

constexpr std::string_view kSecurityForm =
    "the folder of a member, as `fieldcast secure add` makes it, or none";

// Whoever is in the network reads and commands, unless it is said otherwise: that is nobody's
// default.
void read_security(MapReader& map, DdsSpec& spec) {
  std::string given;
  if (map.read("security", given, TextRule{kMaxPath})) {
    if (given == "none") {
      spec.without_security = true;
    } else {
      spec.security = resolve(*map.find("security")->position.source, given);
    }
    if (spec.security && !spec.discovery_servers.empty()) {
      map.faults().add(map.position_of("security"),
                       "security with a discovery server: Fast DDS 2.9 ends the program with it",
                       "one of them; without a discovery server members find each other by "
                       "multicast");
    }
    return;
  }
  if (map.find("security") != nullptr) return;
  for (const std::string& address : spec.interfaces) {
    if (address.starts_with("127.") || !is_ipv4(address)) continue;
    return map.faults().add(
        map.position_of("interfaces"),
        fmt::format("DDS is open to the network at {}, and nothing is said about security",
                    address),
        fmt::format("security: {}", kSecurityForm));
  }
}

}  // namespace

void read_dds(MapReader& file, DdsSpec& spec, Library& library) {
  const Node* node = file.find("dds");
  if (node == nullptr) return;
  MapReader map(*node, dds_rows(), file.faults());
  dds_rows().read(map, spec);
  read_interfaces(map, spec);
  read_servers(map, spec);
  std::string profile;
  if (map.read("profile", profile, TextRule{kMaxPath}))
    spec.profile = library.check_file(*map.find("profile"));
  read_security(map, spec);
}

void read_log(MapReader& file, LogSpec& spec) {
  const Node* node = file.find("log");
  if (node == nullptr) return;
  MapReader map(*node, log_rows(), file.faults());
  log_rows().read(map, spec);
}

}  // namespace fieldcast::config
