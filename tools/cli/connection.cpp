#include "tools/cli/connection.hpp"

#include <fmt/format.h>

#include "bridge/dds/multicast.hpp"
#include "config/loader.hpp"

namespace fieldcast::cli {

void add_connection(CommandLine& line, ConnectionOptions& options) {
  line.text("--config", options.config, "Join the DDS domain of this configuration file")
      .existing_file();
  line.number("--domain", options.domain, 0, 232, "DDS domain (default 0)");
  line.texts("--interface", options.interfaces,
             "IPv4 address that DDS may use (default 127.0.0.1); may be repeated");
}

tl::expected<DdsSpec, std::string> resolve(const ConnectionOptions& options) {
  DdsSpec spec;
  if (!options.config.empty()) {
    auto loaded = config::load_file(options.config);
    if (!loaded) return tl::unexpected(config::to_text(loaded.error()));
    spec = std::move(loaded->dds);
  }
  if (options.domain) spec.domain = *options.domain;
  if (!options.interfaces.empty()) spec.interfaces = options.interfaces;
  return spec;
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
