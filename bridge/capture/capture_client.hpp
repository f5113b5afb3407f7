// One client of the capture service: reads its request, then sends it the blocks of its bus. Blocks
// that it does not read in time are dropped and counted. Lives on the service's thread; pending
// handlers share ownership.
#pragma once

#include <boost/asio/local/stream_protocol.hpp>
#include <boost/asio/steady_timer.hpp>
#include <functional>
#include <memory>
#include <string>

#include "bridge/capture/bus_capture.hpp"

namespace fieldcast {

class CaptureClient final : public CaptureSink, public std::enable_shared_from_this<CaptureClient> {
 public:
  using Socket = boost::asio::local::stream_protocol::socket;
  static constexpr std::size_t kMaxUnsent = 4 << 20;  // bytes
  static constexpr Duration kRequestLimit = std::chrono::seconds{5};
  static constexpr Duration kEndLimit = std::chrono::seconds{1};  // for unsent data at the end

  // `asked` receives the request and calls reply() or begin(). `gone` is called once, at the end.
  CaptureClient(Socket socket, std::function<void(CaptureClient&, const std::string&)> asked,
                std::function<void(CaptureClient&)> gone);

  void start();
  // Sends one text line, then closes.
  void reply(const std::string& text);
  // Sends "ok" and the head of the file; from then on the client is a sink of the bus `name`.
  void begin(const std::string& name, const Bytes& head, UtcTime now);
  // Called when the bus or the bridge ends.
  void end(const std::string& why, UtcTime now);

  void packet(ByteView block, UtcTime at, bool session) override;
  void lost(std::uint64_t records) override { counts_.dropped += records; }
  [[nodiscard]] const std::string& bus() const { return bus_; }  // empty if none

 private:
  void read();
  void came(std::size_t size);
  void send();
  void close();

  Socket socket_;
  boost::asio::steady_timer limit_;
  std::function<void(CaptureClient&, const std::string&)> asked_;
  std::function<void(CaptureClient&)> gone_;
  std::string request_;
  std::array<char, 256> buffer_{};
  Bytes waiting_, sending_;
  std::string bus_;
  CaptureCounts counts_;
  bool ending_ = false;  // closed when everything is sent
};

}  // namespace fieldcast
