#include "tools/forward/outlet/nats/nats_options.hpp"

#include <array>
#include <string_view>
#include <vector>

#include "bridge/process/secret.hpp"

namespace fieldcast::forward {

namespace {

using Done = tl::expected<void, std::string>;

Done checked(natsStatus status, const std::string& what) {
  if (status == NATS_OK) return {};
  const char* const detail = nats_GetLastError(nullptr);
  return tl::make_unexpected(what + ": " + natsStatus_GetText(status) +
                             (detail == nullptr ? "" : std::string(" (") + detail + ")"));
}

Done set_tls(natsOptions* options, const JetStreamSpec& spec) {
  if (!uses_tls(spec)) return {};
  if (auto done = checked(natsOptions_SetSecure(options, true), "TLS"); !done) return done;
  if (!spec.authority.empty()) {
    auto done = checked(natsOptions_LoadCATrustedCertificates(options, spec.authority.c_str()),
                        "authority " + spec.authority);
    if (!done) return done;
  }
  if (spec.certificate.empty()) return {};
  if (auto safe = check_secret_file(spec.key, Readers::kOwnerAndGroup); !safe)
    return tl::make_unexpected(safe.error());
  return checked(
      natsOptions_LoadCertificatesChain(options, spec.certificate.c_str(), spec.key.c_str()),
      "certificate " + spec.certificate);
}

Done set_login(natsOptions* options, const JetStreamSpec& spec) {
  if (!spec.credentials.empty()) {
    if (auto safe = check_secret_file(spec.credentials, Readers::kOwnerAndGroup); !safe)
      return tl::make_unexpected(safe.error());
    return checked(
        natsOptions_SetUserCredentialsFromFiles(options, spec.credentials.c_str(), nullptr),
        "credentials " + spec.credentials);
  }
  const std::string& file = spec.token_file.empty() ? spec.password_file : spec.token_file;
  if (file.empty()) return {};
  const auto secret = read_secret_line(file, Readers::kOwnerAndGroup);
  if (!secret) return tl::make_unexpected(secret.error());
  std::string text(secret->text());
  const natsStatus status = spec.token_file.empty()
                                ? natsOptions_SetUserInfo(options, spec.user.c_str(), text.c_str())
                                : natsOptions_SetToken(options, text.c_str());
  wipe(text);
  return checked(status, "login with " + file);
}

Done set_connection(natsOptions* options, const JetStreamSpec& spec, const std::string& name) {
  constexpr int kConnectMs = 3'000, kWriteMs = 5'000, kWaitMs = 1'000, kJitterMs = 500,
                kPingMs = 10'000;
  constexpr int kPings = 2;  // without a response: the connection is lost
  std::vector<const char*> servers;
  for (const std::string& server : spec.servers) servers.push_back(server.c_str());
  for (const natsStatus status :
       {natsOptions_SetServers(options, servers.data(), static_cast<int>(servers.size())),
        natsOptions_SetName(options, name.c_str()), natsOptions_SetTimeout(options, kConnectMs),
        natsOptions_SetAllowReconnect(options, true), natsOptions_SetMaxReconnect(options, -1),
        natsOptions_SetReconnectWait(options, kWaitMs),
        natsOptions_SetReconnectJitter(options, kJitterMs, kJitterMs),
        natsOptions_SetPingInterval(options, kPingMs), natsOptions_SetMaxPingsOut(options, kPings),
        natsOptions_SetWriteDeadline(options, kWriteMs)}) {
    if (auto done = checked(status, "options of the connection"); !done) return done;
  }
  return {};
}

}  // namespace

tl::expected<NatsOptions, std::string> nats_options(const JetStreamSpec& spec,
                                                    const std::string& name) {
  natsOptions* made = nullptr;
  if (const natsStatus status = natsOptions_Create(&made); status != NATS_OK)
    return tl::make_unexpected(std::string("NATS: ") + natsStatus_GetText(status));
  NatsOptions options(made);
  for (const Done& done :
       {set_connection(made, spec, name), set_tls(made, spec), set_login(made, spec)}) {
    if (!done) return tl::make_unexpected(done.error());
  }
  return options;
}

std::string server_of(natsConnection* connection) {
  std::array<char, 256> url{};
  if (natsConnection_GetConnectedUrl(connection, url.data(), url.size()) != NATS_OK) return "?";
  const std::string_view text(url.data());
  const std::size_t at = text.rfind('@');
  return std::string(at == text.npos ? text : text.substr(at + 1));
}

std::string reason_of(natsConnection* connection) {
  const char* last = nullptr;
  const natsStatus status = natsConnection_GetLastError(connection, &last);
  if (last != nullptr && *last != '\0') return last;
  return status == NATS_OK ? "the server does not respond" : natsStatus_GetText(status);
}

}  // namespace fieldcast::forward
