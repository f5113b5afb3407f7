// What a module has to show before it is taken for the one whose number it tells: where it comes
// from, a certificate, a secret. Made of the configuration; lives on the server's io thread.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "bridge/base/file_stamp.hpp"
#include "bridge/net/tls.hpp"
#include "bridge/program/module_secrets.hpp"
#include "core/access/network.hpp"
#include "core/model/spec.hpp"
#include "core/program/registration.hpp"

namespace fieldcast::program {

class ModuleGate {
 public:
  // The error is one line: a file that is of no use.
  [[nodiscard]] static tl::expected<std::shared_ptr<ModuleGate>, std::string> make(
      const ModulesSpec& spec);

  // `host`: an address without its port.
  [[nodiscard]] bool admits(const std::string& host) const;
  [[nodiscard]] TlsServer* tls() { return tls_.get(); }  // null: none
  // Whether a module has to prove something: it is then told why it is refused. One that only has a
  // registration text would pass the words on to its PLC.
  [[nodiscard]] bool asks() const { return tls_ || secrets_; }
  // A new one for each module. Secrets that have changed are read again; while their file is of no
  // use, nobody knows one.
  [[nodiscard]] Challenge challenge();
  // Why the certificate with this common name is none for this number; empty: it is one, or none
  // is asked for.
  [[nodiscard]] std::string fault_of(const std::string& common_name,
                                     const std::string& number) const;

 private:
  explicit ModuleGate(const ModulesSpec& spec) : spec_(spec) {}

  const ModulesSpec spec_;
  std::vector<access::Network> networks_;
  std::unique_ptr<TlsServer> tls_;
  std::shared_ptr<const ModuleSecrets> secrets_;
  FileStamp read_;  // their file, when it was read last
};

}  // namespace fieldcast::program
