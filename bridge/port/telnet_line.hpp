// Connection to a server of RFC 2217. Translates between its socket and one end of a socket pair.
// The other end is the line of a bus or of a programming session. Owns socket and pair. On its
// bus's io thread; pending handlers share ownership and do nothing after the end.
#pragma once

#include <boost/asio/steady_timer.hpp>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "bridge/port/stream.hpp"
#include "core/telnet/line_client.hpp"

namespace fieldcast {

class TelnetLine : public std::enable_shared_from_this<TelnetLine> {
 public:
  // More bytes that the server does not read close the connection.
  static constexpr std::size_t kMaxResponses = 65536;

  // One of them is called once, not inside start() and not after close().
  struct Handlers {
    std::function<void(FileDescriptor line)> opened;  // all settings are in force
    std::function<void(Stream::End)> failed;
  };

  // `socket`: connected and non-blocking.
  TelnetLine(boost::asio::io_context& io, FileDescriptor socket, const LineFormat& line);

  void start(Handlers handlers);
  // Moves bytes that have arrived to the other end.
  void turn();
  // Changes a setting of the opened line. `done` is called once, perhaps inside the call.
  void change(const telnet::LineChange& change, telnet::LineChangeDone done);
  // Whether a change may have left other settings than the constructor's.
  [[nodiscard]] bool changed() const { return client_.changes_line(); }
  void close();
  // Reason of the end of an opened line; empty while it is open.
  [[nodiscard]] const std::string& reason() const { return reason_; }

 private:
  void from_server();
  void on_open();
  void from_line();
  bool read_line();  // false: no more bytes
  void flush();
  void wait();
  enum Wait : unsigned { kServerReads = 1, kServerWrites = 2, kLineReads = 4, kLineWrites = 8 };
  void wait_for(Wait what);
  void wait_for_deadline();
  void tell_changed();
  void end(Stream::End end);

  FileDescriptor socket_, pair_;
  Readiness server_ready_, line_ready_;
  boost::asio::steady_timer timer_;
  Handlers handlers_;
  Bytes to_server_, to_line_;
  telnet::LineClient client_;
  std::vector<std::pair<telnet::LineChange, telnet::LineChangeDone>> changes_;
  std::string reason_;
  unsigned waiting_ = 0;  // for each Wait
  bool opened_ = false;
  bool over_ = false;
};

}  // namespace fieldcast
