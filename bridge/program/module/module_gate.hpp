// Checks that a module proves the number it sends: its source address, a certificate, a secret.
// Built from the configuration; runs on the server's io thread.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "bridge/base/file_stamp.hpp"
#include "bridge/net/tls.hpp"
#include "bridge/program/module/module_secrets.hpp"
#include "core/access/network.hpp"
#include "core/model/program_spec.hpp"
#include "core/program/registration.hpp"

namespace fieldcast::program {

class ModuleGate {
 public:
  // The error is one line: a file that cannot be used.
  [[nodiscard]] static tl::expected<std::shared_ptr<ModuleGate>, std::string> make(
      const ModulesSpec& spec);

  // `host` is an address without its port.
  [[nodiscard]] bool admits(const std::string& host) const;
  [[nodiscard]] TlsServer* tls() { return tls_.get(); }  // null without TLS
  // Returns true if a module must authenticate; it then receives the reason of a refusal. A module
  // with only a registration text would pass the reason on to its PLC.
  [[nodiscard]] bool asks() const { return tls_ || secrets_; }
  // Returns a new challenge for each module. Reads changed secrets again; while their file is
  // invalid, no secret is accepted.
  [[nodiscard]] Challenge challenge();
  // Reason why the certificate with this common name is not valid for this number; empty if it is
  // valid or none is required.
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
