#include "bridge/program/module/module_gate.hpp"

#include <fmt/format.h>
#include <sodium.h>

#include <algorithm>
#include <array>

#include "bridge/base/check.hpp"
#include "bridge/log/log.hpp"
#include "bridge/process/secret.hpp"
#include "core/program/frame.hpp"

namespace fieldcast::program {

namespace {

constexpr std::string_view kAny = "*";
// Separates the proof from other uses of the secret.
constexpr std::string_view kPurpose = "fieldcast module ";
constexpr std::size_t kChallengeBytes = 32;

void start_sodium() {
  static const int started = sodium_init();
  FIELDCAST_CHECK(started >= 0);
}

template <std::size_t Size>
std::string hexadecimal(const std::array<unsigned char, Size>& bytes) {
  std::string text(2 * Size + 1, '\0');
  sodium_bin2hex(text.data(), text.size(), bytes.data(), bytes.size());
  text.pop_back();
  return text;
}

const unsigned char* bytes_of(std::string_view text) {
  return reinterpret_cast<const unsigned char*>(text.data());
}

std::string_view without_blanks(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r");
  if (first == text.npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

}  // namespace

tl::expected<ModuleSecrets, std::string> ModuleSecrets::read(const std::string& path) {
  const auto file = read_secret_file(path, Readers::kOwnerAndGroup);
  if (!file) return tl::unexpected(file.error());
  ModuleSecrets made;
  std::string_view rest = file->text();
  for (unsigned number = 1; !rest.empty(); ++number) {
    const auto end = rest.find('\n');
    const std::string_view line = without_blanks(rest.substr(0, end));
    rest = end == rest.npos ? std::string_view{} : rest.substr(end + 1);
    if (line.empty() || line.starts_with('#')) continue;
    const auto wrong = [&](std::string_view what) {
      return tl::unexpected(fmt::format("{}:{}: {}", path, number, what));
    };
    const auto blank = line.find_first_of(" \t");
    const std::string_view module = line.substr(0, blank);
    if (blank == line.npos || (module != kAny && !is_device_number(module)))
      return wrong("this is no line of secrets; expected: a module's number, or '*', and a secret");
    const std::string_view secret = without_blanks(line.substr(blank));
    if (secret.size() < kMinSecret)
      return wrong(fmt::format(
          "a secret has at least {} characters; 'openssl rand -hex 32' makes one", kMinSecret));
    if (!made.secrets_.try_emplace(std::string(module), secret).second)
      return wrong("a second secret of the same module");
  }
  if (made.secrets_.empty()) return tl::unexpected(path + ": no secret is in it");
  return made;
}

bool ModuleSecrets::fits(std::string_view number, std::string_view challenge,
                         std::string_view response) const {
  auto found = secrets_.find(number);
  if (found == secrets_.end()) found = secrets_.find(kAny);
  return found != secrets_.end() &&
         same_bytes(response, response_to(challenge, number, found->second));
}

std::string new_challenge() {
  start_sodium();
  std::array<unsigned char, kChallengeBytes> chance{};
  randombytes_buf(chance.data(), chance.size());
  return hexadecimal(chance);
}

std::string response_to(std::string_view challenge, std::string_view number, const Secret& secret) {
  start_sodium();
  const std::string text = fmt::format("{}{} {}", kPurpose, number, challenge);
  crypto_auth_hmacsha256_state state;
  crypto_auth_hmacsha256_init(&state, bytes_of(secret.text()), secret.size());
  crypto_auth_hmacsha256_update(&state, bytes_of(text), text.size());
  std::array<unsigned char, crypto_auth_hmacsha256_BYTES> code{};
  crypto_auth_hmacsha256_final(&state, code.data());
  sodium_memzero(&state, sizeof state);
  return hexadecimal(code);
}

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
  return {text, [secrets = secrets_, text](std::string_view number, std::string_view response) {
            return secrets->fits(number, text, response);
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
