#include "bridge/program/access_text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <vector>

#include "bridge/net/tls.hpp"
#include "bridge/program/module/module_gate.hpp"

namespace fieldcast::program {
namespace {

std::string address_text(const ListenSpec& listen) {
  const bool v6 = listen.host.find(':') != std::string::npos;
  return fmt::format("{}:{}", v6 ? '[' + listen.host + ']' : listen.host, listen.port);
}

std::string tls_text(const TlsSpec& tls) {
  if (tls.authority.empty()) return "TLS";
  return fmt::format("TLS with a certificate of {}{}", tls.authority,
                     tls.revoked.empty() ? "" : " that is not revoked");
}

std::string tls_of(const EngineersSpec& engineers) {
  if (engineers.tls.certificate.empty()) return "no TLS";
  return engineers.proof == LoginProof::kEither ? "TLS" : tls_text(engineers.tls);
}

std::string login_text(const EngineersSpec& engineers) {
  const bool far = !on_loopback(engineers.listen);
  switch (engineers.proof) {
    case LoginProof::kCertificate: return "the certificate is the login";
    case LoginProof::kBoth: return "a login with the certificate and the password of a user";
    default: break;
  }
  if (!far && engineers.login == LoginRule::kOffLoopback) return "no login on the loopback";
  return engineers.proof == LoginProof::kEither
             ? "a login with the certificate or the password of a user"
             : "a login with the password of a user";
}

// `why` begins with the path of the file.
AccessFault fault_of(const std::string& part, const TlsSpec& tls, const std::string& secrets,
                     const std::string& why) {
  const std::pair<const char*, const std::string&> files[] = {{".certificate", tls.certificate},
                                                              {".key", tls.key},
                                                              {".authority", tls.authority},
                                                              {".revoked", tls.revoked},
                                                              {".secrets", secrets}};
  AccessFault fault{part, fmt::format("{}: {}", part, why)};
  for (const auto& [key, path] : files) {
    if (!path.empty() && why.starts_with(path + ':')) fault.key = part + key;
  }
  return fault;
}

}  // namespace

std::string to_text(const ModulesSpec& modules) {
  std::vector<std::string> shown;
  if (!modules.tls.certificate.empty()) shown.push_back(tls_text(modules.tls));
  if (!modules.secrets.empty()) shown.push_back("the secret of " + modules.secrets);
  if (!modules.from.empty()) shown.push_back(fmt::format("from {}", fmt::join(modules.from, ", ")));
  const bool open =
      modules.tls.authority.empty() && modules.secrets.empty() && modules.from.empty();
  if (open)
    shown.emplace_back(
        on_loopback(modules.listen)
            ? "every program on this machine can claim to be any of them"
            : "security: none, every client that reaches the port can claim to be any of them");
  return fmt::format(
      "modules dial in at {}: {}; a second one of a number {}", address_text(modules.listen),
      fmt::join(shown, ", "),
      modules.second == SecondModule::kRefuse ? "is refused" : "takes the place of the first");
}

std::string to_text(const EngineersSpec& engineers) {
  return fmt::format("engineers connect at {}: {}, {}", address_text(engineers.listen),
                     tls_of(engineers), login_text(engineers));
}

std::optional<AccessFault> check_files(const ProgramSpec& program) {
  if (const auto& modules = program.modules) {
    if (const auto gate = ModuleGate::make(*modules); !gate)
      return fault_of("modules", modules->tls, modules->secrets, gate.error());
  }
  const auto& engineers = program.engineers;
  if (engineers && !engineers->tls.certificate.empty()) {
    if (const auto tls = TlsServer::make(engineers->tls); !tls)
      return fault_of("engineers", engineers->tls, {}, tls.error());
  }
  return std::nullopt;
}

}  // namespace fieldcast::program
