#include "config/sections/dds.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "config/document/document.hpp"
#include "config/document/limits.hpp"
#include "config/document/scalars.hpp"
#include "config/sections/bridge_keys.hpp"
#include "config/sections/port.hpp"

namespace fieldcast::config {
namespace {

void read_interfaces(MapReader& map, DdsSpec& spec) {
  const Node* node = map.find("interfaces");
  if (node == nullptr) return;
  if (!is_list(*node, "interfaces", 1, kMaxInterfaces,
               fmt::format("a list of 1 to {} IPv4 addresses", kMaxInterfaces), map.faults(),
               is_ipv4(node->text) ? as_list(*node) : ""))
    return;
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

constexpr int kServerPort = 11811;  // default of a discovery server

void check_host_port(MapReader& map, const Position& position, std::string_view key,
                     const std::string& text, int usual_port) {
  if (host_port_from(text)) return;
  map.faults().add(position, fmt::format("{} '{}' names no host and port", key, text),
                   "HOST:PORT with a port 1 to 65535",
                   text.find(':') == text.npos ? fmt::format("{}:{}", text, usual_port) : "");
}

void read_hosts(MapReader& map, std::string_view key, std::size_t most, int usual_port,
                std::vector<std::string>& target) {
  const Node* node = map.find(key);
  if (node == nullptr) return;
  if (!is_list(*node, key, 1, most, fmt::format("a list of 1 to {} HOST:PORT", most), map.faults(),
               as_list(*node)))
    return;
  for (const Node* item : node->items) {
    const std::string* text = scalar_of(*item, key, "HOST:PORT", map.faults());
    if (text == nullptr) continue;
    check_host_port(map, item->position, key, *text, usual_port);
    if (std::ranges::find(target, *text) != target.end())
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
    map.fault("discovery-server", "'discovery-server' and 'discovery-servers' in one map",
              "one of them");
  }
  spec.discovery_servers = std::move(several);
}

constexpr std::string_view kSecurityForm =
    "the folder of a member, as `fieldcast secure add` makes it, or none";

// Must be explicit: without security, every host in the network can read and command.
void read_security(MapReader& map, DdsSpec& spec) {
  std::string given;
  if (map.read("security", given, TextRule{kMaxPath})) {
    if (given == "none") {
      spec.without_security = true;
    } else {
      spec.security = resolve(*map.find("security")->position.source, given);
    }
    if (spec.security && !spec.discovery_servers.empty()) {
      map.fault("security",
                "security with a discovery server: Fast DDS 2.9 ends the program with it",
                "one of them; without a discovery server members find each other by multicast");
    }
    if (spec.security && spec.domain > kMaxSecureDomain) {
      map.fault("domain",
                fmt::format("security in domain {}: Cyclone DDS reads no document that names it",
                            spec.domain),
                fmt::format("a domain 0 to {} with security", kMaxSecureDomain));
    }
    return;
  }
  if (map.find("security") != nullptr) return;
  for (const std::string& address : spec.interfaces) {
    if (address.starts_with("127.") || !is_ipv4(address)) continue;
    return map.fault(
        "interfaces",
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

std::vector<DdsSite> read_sites(MapReader& file, Library& library) {
  std::vector<DdsSite> sites;
  const Node* node = file.find("sites");
  if (node == nullptr) {
    read_dds(file, sites.emplace_back().dds, library);
    return sites;
  }
  if (file.find("dds") != nullptr) {
    file.fault("dds", "'dds' and 'sites' in one map",
               "one of them: each site has a 'dds' of its own");
  }
  if (!is_list(*node, "sites", 1, kMaxSites,
               fmt::format("a list of 1 to {} sites, each {{ name: N, dds: {{ .. }} }}", kMaxSites),
               file.faults()))
    return sites;
  UniqueNames names;
  for (const Node* item : node->items) {
    MapReader map(*item, site_rows(), file.faults());
    DdsSite& site = sites.emplace_back();
    site_rows().read(map, site);
    if (!site.name.empty()) names.add("site", site.name, map.position_of("name"), file.faults());
    read_dds(map, site.dds, library);
    // The library keeps one participant profile per name until the process ends.
    if (site.dds.profile && sites.size() > 1 && sites.front().dds.profile != site.dds.profile) {
      file.faults().add(item->position, "sites with different profiles",
                        "the same profile for all sites, or a program for each");
    }
  }
  return sites;
}

void read_log(MapReader& file, LogSpec& spec) { log_rows().read_section(file, "log", spec); }

}  // namespace fieldcast::config
