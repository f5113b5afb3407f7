#include "bridge/program/module/module_gate.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "bridge/log/log.hpp"

namespace fieldcast::program {

tl::expected<std::shared_ptr<ModuleGate>, std::string> ModuleGate::make(const ModulesSpec& spec) {
  std::shared_ptr<ModuleGate> gate(new ModuleGate(spec));
  for (const std::string& text : spec.from) {
    const auto network = access::Network::parse(text);
    if (!network) return tl::unexpected("'" + text + "' is no address and no network");
    gate->networks_.push_back(*network);
  }
  if (!spec.tls.certificate.empty()) {
    auto tls = TlsServer::make(spec.tls);
    if (!tls) return tl::unexpected(tls.error());
    gate->tls_ = *std::move(tls);
  }
  if (!spec.secrets.empty()) {
    gate->read_ = FileStamp::of(spec.secrets);
    auto secrets = ModuleSecrets::read(spec.secrets);
    if (!secrets) return tl::unexpected(secrets.error());
    gate->secrets_ = std::make_shared<const ModuleSecrets>(*std::move(secrets));
  }
  return gate;
}

bool ModuleGate::admits(const std::string& host) const {
  return networks_.empty() || std::ranges::any_of(networks_, [&](const access::Network& each) {
           return each.contains(host);
         });
}

Challenge ModuleGate::challenge() {
  if (!secrets_) return {};
  if (const FileStamp now = FileStamp::of(spec_.secrets); now != read_) {
    read_ = now;
    auto secrets = ModuleSecrets::read(spec_.secrets);
    if (!secrets)
      log_error("modules", secrets.error() + "; no module can connect until that is fixed");
    secrets_ =
        std::make_shared<const ModuleSecrets>(secrets ? *std::move(secrets) : ModuleSecrets{});
  }
  const std::string text = new_challenge();
  return {text, [secrets = secrets_, text](std::string_view number, std::string_view answer) {
            return secrets->fits(number, text, answer);
          }};
}

std::string ModuleGate::fault_of(const std::string& common_name, const std::string& number) const {
  if (spec_.tls.authority.empty()) return {};
  if (common_name.empty()) return "the certificate of the module has no common name";
  const auto listed = spec_.subjects.find(common_name);
  const bool fits = listed == spec_.subjects.end()
                        ? common_name == number
                        : std::ranges::find(listed->second, number) != listed->second.end();
  return fits ? ""
              : fmt::format("the certificate of '{}' is none for module {}", common_name, number);
}

}  // namespace fieldcast::program
