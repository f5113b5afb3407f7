#include "tools/cli/domain/connection.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <fstream>

#include "bridge/dds/transport/join_check.hpp"
#include "bridge/dds/transport/network_check.hpp"
#include "bridge/security/member_folder.hpp"
#include "config/loader/loader.hpp"
#include "core/model/channel_pattern.hpp"
#include "tools/cli/terminal/interrupt.hpp"
#include "tools/station/settings/configuration.hpp"

namespace fieldcast::cli {

void add_connection(CommandLine& line, ConnectionOptions& options) {
  line.text("--config", options.config,
            "Join the DDS domain of this configuration file, a bridge's or a station's")
      .existing_file();
  line.number("--domain", options.domain, 0, 232, "DDS domain (default 0)");
  line.texts("--interface", options.interfaces,
             "IPv4 address that DDS may use (default 127.0.0.1); may be repeated");
  line.value(
      "--security",
      [&options](const std::string& text) -> std::optional<std::string> {
        // An empty variable of a script would otherwise join without security unnoticed.
        if (text.empty()) return "is empty; name the folder of a member, or leave it out";
        options.security = text;
        return std::nullopt;
      },
      "Join as the member whose folder this is (fieldcast secure add)");
}

namespace {

// Checks the spec before joining, because the library's messages are not useful to the user.
std::string fault_of_joining(const DdsSpec& spec) {
  std::string text;
  for (const JoinRemark& fault : check_joining(spec, {}, utc_now()).faults)
    text += (text.empty() ? "" : "\n") + to_text(fault);
  return text;
}

// Only a station's file has one of these keys.
bool is_of_station(const std::string& path) {
  std::ifstream file(path);
  for (std::string text; std::getline(file, text);) {
    for (const std::string_view key : {"station:", "sites:", "web:", "record:"}) {
      if (text.starts_with(key)) return true;
    }
  }
  return false;
}

tl::expected<Connection, std::string> connection_of(const std::string& path) {
  if (is_of_station(path)) {
    auto loaded = web::load_station(path);
    if (!loaded) return tl::unexpected(config::to_text(loaded.error()));
    if (loaded->sites.empty())
      return tl::unexpected(fmt::format(
          "{} has only a 'stream' and joins no DDS domain; use a file with 'dds' or 'sites'",
          path));
    return Connection(std::move(loaded->sites));
  }
  auto loaded = config::load_file(path);
  if (!loaded) return tl::unexpected(config::to_text(loaded.error()));
  return Connection(std::move(loaded->dds));
}

}  // namespace

tl::expected<Connection, std::string> resolve(const ConnectionOptions& options) {
  Connection found{DdsSpec{}};
  if (!options.config.empty()) {
    auto loaded = connection_of(options.config);
    if (!loaded) return loaded;
    found = *std::move(loaded);
  }
  if (found.sites.size() > 1 &&
      (options.domain || !options.interfaces.empty() || !options.security.empty())) {
    return tl::unexpected(fmt::format(
        "{} has several sites, each with a domain of its own: leave out --domain, --interface and "
        "--security",
        options.config));
  }
  for (DdsSite& site : found.sites) {
    if (options.domain) site.dds.domain = *options.domain;
    if (!options.interfaces.empty()) site.dds.interfaces = options.interfaces;
    if (!options.security.empty()) site.dds.security = options.security;
    if (std::string fault = fault_of_joining(site.dds); !fault.empty())
      return tl::unexpected(std::move(fault));
  }
  return found;
}

std::string held_remark(const Connection& connection, std::string_view bus) {
  for (const DdsSite& site : connection.sites) {
    const std::string prefix = site.name.empty() ? "" : site.name + ':';
    if (!site.dds.security || !bus.starts_with(prefix)) continue;
    const std::string_view there = bus.substr(prefix.size());
    const auto member = security::read_member(*site.dds.security);
    if (!member || member->buses.empty() ||
        std::ranges::any_of(member->buses,
                            [&](const auto& one) { return glob_matches(one, there); }))
      continue;
    return fmt::format("; {} {} may command {} only", to_text(member->role), member->name,
                       fmt::join(member->buses, ", "));
  }
  return {};
}

std::string not_served_text(const Connection& connection, std::string_view bus) {
  return fmt::format("no bridge that serves {} was found in {} within {}; it was not sent{}", bus,
                     domain_text(connection), to_text(kBridgeWait), held_remark(connection, bus));
}

std::string no_result_text(const Connection& connection, std::string_view bus, Duration limit) {
  return fmt::format("no result within {}; whether it was executed is not known{}", to_text(limit),
                     held_remark(connection, bus));
}

std::string domain_text(const Connection& connection) {
  if (connection.sites.size() > 1) {
    std::string text = "the sites ";
    for (std::size_t i = 0; i < connection.sites.size(); ++i)
      text += (i == 0 ? "" : ", ") + connection.sites[i].name;
    return text;
  }
  const DdsSpec& spec = connection.sites.front().dds;
  return fmt::format("DDS domain {} on {}", spec.domain, fmt::join(spec.interfaces, ", "));
}

namespace {

// A secured member finds only secured members, and a bridge that refuses it sends no notice.
std::string member_remark(const Connection& connection) {
  std::string folders;
  for (const DdsSite& site : connection.sites) {
    if (site.dds.security) folders += (folders.empty() ? "" : ", ") + *site.dds.security;
  }
  if (folders.empty()) return {};
  return fmt::format(
      "; by security ({}) only members of the same authority find each other, and none who is "
      "revoked or whose certificate has ended: `fieldcast secure show` says it at the authority",
      folders);
}

}  // namespace

std::string no_bridge_text(const Connection& connection, const std::vector<std::string>& missing) {
  for (const DdsSite& site : connection.sites) {
    const std::vector<std::string>& named = site.dds.discovery_servers;
    std::vector<std::string> absent;
    for (const std::string& server : named) {
      if (std::find(missing.begin(), missing.end(), server) != missing.end())
        absent.push_back(server);
    }
    if (const auto remark = servers_remark(named, absent))
      return fmt::format("no bridge found in {}: {}", domain_text(connection), *remark);
    if (const auto alone = multicast_remark(site.dds))
      return fmt::format("no bridge found in {}: {}", domain_text(connection), *alone);
  }
  return fmt::format(
      "no bridge found in {} within {}: is fieldcast-bridge running, with the same domain and "
      "interfaces? (--config FILE, or --domain N and --interface A){}",
      domain_text(connection), to_text(kBridgeWait), member_remark(connection));
}

void add_store(CommandLine& line, StoreSource& source) {
  line.text("--config", source.config, "Look into the store of this configuration file")
      .existing_file();
  line.text("--store", source.store,
            "Look into this store: a file, or postgresql://USER@HOST/DATABASE");
}

tl::expected<StoreAddress, std::string> resolve(const StoreSource& source) {
  if (!source.store.empty()) return StoreAddress(source.store);
  if (source.config.empty())
    return tl::unexpected(
        std::string("which store? --config FILE with a 'store' section, or --store FILE"));
  const auto loaded = config::load_file(source.config);
  if (!loaded) return tl::unexpected(config::to_text(loaded.error()));
  if (!loaded->store)
    return tl::unexpected(source.config +
                          ": there is no 'store' section: the bridge stores nothing");
  return StoreAddress(loaded->store->address);
}

}  // namespace fieldcast::cli
