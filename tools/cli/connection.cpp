#include "tools/cli/connection.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "bridge/dds/multicast.hpp"
#include "bridge/security/authority.hpp"
#include "bridge/security/member_folder.hpp"
#include "config/loader.hpp"
#include "core/model/pattern.hpp"
#include "tools/cli/clock.hpp"

namespace fieldcast::cli {

void add_connection(CommandLine& line, ConnectionOptions& options) {
  line.text("--config", options.config, "Join the DDS domain of this configuration file")
      .existing_file();
  line.number("--domain", options.domain, 0, 232, "DDS domain (default 0)");
  line.texts("--interface", options.interfaces,
             "IPv4 address that DDS may use (default 127.0.0.1); may be repeated");
  line.text("--security", options.security,
            "Join as the member whose folder this is (fieldcast secure add)");
}

namespace {

// Why nothing would be received, in the words of the folder instead of the library's.
std::string fault_of_security(const std::string& folder) {
  std::string text;
  for (const std::string& fault : security::check_program(folder, false, utc_now()).faults)
    text += (text.empty() ? "security: " : "\nsecurity: ") + fault;
  return text;
}

}  // namespace

tl::expected<DdsSpec, std::string> resolve(const ConnectionOptions& options) {
  DdsSpec spec;
  if (!options.config.empty()) {
    auto loaded = config::load_file(options.config);
    if (!loaded) return tl::unexpected(config::to_text(loaded.error()));
    spec = std::move(loaded->dds);
  }
  if (options.domain) spec.domain = *options.domain;
  if (!options.interfaces.empty()) spec.interfaces = options.interfaces;
  if (!options.security.empty()) spec.security = options.security;
  if (spec.security) {
    if (std::string fault = fault_of_security(*spec.security); !fault.empty())
      return tl::unexpected(std::move(fault));
  }
  return spec;
}

std::string held_remark(const DdsSpec& spec, std::string_view bus) {
  if (!spec.security) return {};
  const auto member = security::read_member(*spec.security);
  if (!member || member->buses.empty() ||
      std::ranges::any_of(member->buses, [&](const auto& one) { return glob_matches(one, bus); }))
    return {};
  std::string buses;
  for (const std::string& one : member->buses) buses += (buses.empty() ? "" : ", ") + one;
  return fmt::format("; {} {} may command {} only", to_text(member->role), member->name, buses);
}

std::string domain_text(const DdsSpec& spec) {
  std::string text = fmt::format("DDS domain {} on ", spec.domain);
  for (std::size_t i = 0; i < spec.interfaces.size(); ++i)
    text += (i == 0 ? "" : ", ") + spec.interfaces[i];
  return text;
}

std::string no_bridge_text(const DdsSpec& spec) {
  if (const auto alone = multicast_remark(spec))
    return fmt::format("no bridge found in {}: {}", domain_text(spec), *alone);
  return fmt::format(
      "no bridge found in {} within {}: is fieldcast-bridge running, with the same domain and "
      "interfaces? (--config FILE, or --domain N and --interface A)",
      domain_text(spec), to_text(kBridgeWait));
}

}  // namespace fieldcast::cli
