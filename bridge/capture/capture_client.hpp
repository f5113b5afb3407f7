// One client of the capture service: reads its request, then gives it the blocks of its bus. What
// it does not take in time is dropped and counted; the end says how many frames that were.
//
// Lives on the service's thread, shared with its own handlers under way.
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
  static constexpr std::size_t kMaxUnsent = 4 << 20;                  // bytes
  static constexpr Duration kRequestLimit = std::chrono::seconds{5};  // for the request
  static constexpr Duration kEndLimit = std::chrono::seconds{1};      // for the rest, at the end

  // `asked` takes the request, and answers with answer() or begin(). `gone` is called once, when
  // the client has ended or was ended.
  CaptureClient(Socket socket, std::function<void(CaptureClient&, const std::string&)> asked,
                std::function<void(CaptureClient&)> gone);

  void start();
  // One text line, then the end.
  void answer(const std::string& text);
  // "ok", then what the file begins with. From now on it is a sink of the bus `name`.
  void begin(const std::string& name, const Bytes& head, UtcTime now);
  // The bus ends, or the bridge.
  void end(const std::string& why, UtcTime now);

  void packet(ByteView block, UtcTime at) override;
  void lost(std::uint64_t records) override { counts_.dropped += records; }
  [[nodiscard]] const std::string& bus() const { return bus_; }  // empty: of none

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
  bool ending_ = false;  // it is closed when everything is sent
};

}  // namespace fieldcast
