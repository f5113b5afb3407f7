// A TLS client as a filter between the bytes of a socket and plain bytes, for lines that are read
// and written without waiting. No socket, no clock, no thread.
#pragma once

#include <memory>
#include <string>
#include <tl/expected.hpp>

#include "core/base/bytes.hpp"
#include "core/model/tls_spec.hpp"

namespace fieldcast {

class TlsEngine {
 public:
  // `server`: host name or IP address that the server's certificate must have. The error is one
  // line that names the file: it is missing, has other contents, or is a key that others can read.
  [[nodiscard]] static tl::expected<std::unique_ptr<TlsEngine>, std::string> make(
      const TlsSpec& files, const std::string& server);
  ~TlsEngine();
  TlsEngine(const TlsEngine&) = delete;
  TlsEngine& operator=(const TlsEngine&) = delete;

  // Accepts received bytes, at first none. Appends plain bytes to `plain`, and to `out` what must
  // be sent. Returns false if the connection must end after that; see fault().
  [[nodiscard]] bool receive(ByteView bytes, Bytes& plain, Bytes& out);
  // Appends the encrypted bytes to `out`, none after a fault. REQUIRES: ready().
  void send(ByteView plain, Bytes& out);
  [[nodiscard]] bool ready() const;  // the handshake is complete
  // Human-readable, one line.
  [[nodiscard]] const std::string& fault() const { return fault_; }

 private:
  struct State;
  explicit TlsEngine(std::unique_ptr<State> state);
  [[nodiscard]] bool goes_on(int result);
  [[nodiscard]] std::string reason() const;
  void drain(Bytes& out);

  std::unique_ptr<State> state_;
  std::string fault_;
};

}  // namespace fieldcast
