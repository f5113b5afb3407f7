// The secrets of modules, and the proof of one: the module responds to a random challenge with the
// HMAC-SHA-256 of the challenge and its number. Any thread, one at a time.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <vector>

#include "bridge/base/file_stamp.hpp"
#include "bridge/net/tls.hpp"
#include "bridge/process/secret.hpp"
#include "core/access/network.hpp"
#include "core/model/program_spec.hpp"
#include "core/program/registration.hpp"

namespace fieldcast::program {

class ModuleSecrets {
 public:
  // bytes: an eavesdropper could try all shorter ones
  static constexpr std::size_t kMinSecret = 16;

  // Reads lines with a number and its secret, or '*' and the secret of all other numbers; '#'
  // begins a comment. The error is one line without a word of the file.
  [[nodiscard]] static tl::expected<ModuleSecrets, std::string> read(const std::string& path);

  // Also returns false for a number without a secret. Its duration does not depend on the response.
  [[nodiscard]] bool fits(std::string_view number, std::string_view challenge,
                          std::string_view response) const;

 private:
  std::map<std::string, Secret, std::less<>> secrets_;
};

// 64 random hexadecimal digits.
[[nodiscard]] std::string new_challenge();
// The response of a module: 64 hexadecimal digits.
[[nodiscard]] std::string response_to(std::string_view challenge, std::string_view number,
                                      const Secret& secret);

// Checks a module's proof of its number: address, certificate, secret. On the server's io thread.
class ModuleGate {
 public:
  // The error is one line: a file that cannot be used.
  [[nodiscard]] static tl::expected<std::shared_ptr<ModuleGate>, std::string> make(
      const ModulesSpec& spec);

  // `host` is an address without its port.
  [[nodiscard]] bool admits(const std::string& host) const;
  [[nodiscard]] TlsServer* tls() { return tls_.get(); }  // null without TLS
  // Returns true if a module must authenticate. Other modules would pass a refusal to their PLC.
  [[nodiscard]] bool asks() const { return tls_ || secrets_; }
  // A new challenge. Reads changed secrets again; an invalid file accepts no secret.
  [[nodiscard]] Challenge challenge();
  // Why the certificate of this common name is not valid for this number; empty if it is.
  [[nodiscard]] std::string fault_of(const std::string& common_name,
                                     const std::string& number) const;

 private:
  explicit ModuleGate(const ModulesSpec& spec) : spec_(spec) {}

  const ModulesSpec spec_;
  std::vector<access::Network> networks_;
  std::unique_ptr<TlsServer> tls_;
  std::shared_ptr<const ModuleSecrets> secrets_;
  FileStamp read_;  // stamp of the file when it was last read
};

}  // namespace fieldcast::program
