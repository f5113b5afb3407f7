#include "bridge/port/tcp_opening.hpp"

#include <fmt/format.h>
#include <netdb.h>
#include <pthread.h>

#include <atomic>
#include <boost/asio/connect.hpp>
#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/write.hpp>
#include <cerrno>
#include <cstring>
#include <mutex>
#include <system_error>
#include <thread>

#include "bridge/base/file_descriptor.hpp"

namespace fieldcast {

namespace asio = boost::asio;
using asio::ip::tcp;

// The work guard is empty after cancel(): the thread does not use the io_context any more.
struct NameLookup::Pending : std::enable_shared_from_this<Pending> {
  using Guard = asio::executor_work_guard<asio::io_context::executor_type>;

  Pending(asio::io_context& io, std::function<void(const Found&)> then)
      : done(std::move(then)), guard(io.get_executor()) {}

  void give(Found found) {
    const std::lock_guard lock(mutex);
    if (!guard) return;
    asio::post(guard->get_executor(), [self = shared_from_this(), found = std::move(found)] {
      if (const auto then = self->end()) then(found);
    });
  }
  // Returns the callback the first time. The caller destroys it without the lock.
  std::function<void(const Found&)> end() {
    const std::lock_guard lock(mutex);
    guard.reset();
    return std::exchange(done, {});
  }

  std::mutex mutex;
  std::function<void(const Found&)> done;
  std::optional<Guard> guard;
};

namespace {

tl::unexpected<std::string> fault_of(const std::string& host, const std::string& why) {
  return tl::unexpected(fmt::format("host name '{}': {}", host, why));
}

NameLookup::Found addresses_of(const std::string& host) {
  addrinfo wanted{};
  wanted.ai_family = AF_UNSPEC;
  wanted.ai_socktype = SOCK_STREAM;  // one entry for each address
  addrinfo* list = nullptr;
  const int fault = ::getaddrinfo(host.c_str(), nullptr, &wanted, &list);
  if (fault != 0)
    return fault_of(host, fault == EAI_SYSTEM ? errno_text(errno) : ::gai_strerror(fault));
  const std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)> owner(list, ::freeaddrinfo);
  std::vector<asio::ip::address> found;
  for (const addrinfo* one = list; one != nullptr; one = one->ai_next) {
    tcp::endpoint endpoint;
    if (one->ai_addrlen > endpoint.capacity()) continue;
    std::memcpy(endpoint.data(), one->ai_addr, one->ai_addrlen);
    found.push_back(endpoint.address());
  }
  if (found.empty()) return fault_of(host, "it has no address");
  return found;
}

// Lookups whose thread has not ended. A port begins one each few seconds while it cannot open.
std::atomic<unsigned> lookups{0};

}  // namespace

void NameLookup::start(const std::string& host, std::function<void(const Found&)> done) {
  cancel();
  pending_ = std::make_shared<Pending>(io_, std::move(done));
  boost::system::error_code is_name;
  const auto address = asio::ip::make_address(host, is_name);
  if (!is_name) return pending_->give(std::vector{address});
  if (++lookups > kMost) {
    --lookups;
    return pending_->give(fault_of(host, "too many lookups wait for name servers"));
  }
  try {
    std::thread([host, pending = pending_] {
      pthread_setname_np(pthread_self(), "names");
      pending->give(addresses_of(host));
      --lookups;
    }).detach();
  } catch (const std::system_error& error) {
    --lookups;
    pending_->give(fault_of(host, error.what()));
  }
}

void NameLookup::cancel() {
  if (const auto pending = std::exchange(pending_, nullptr)) (void)pending->end();
}

TcpOpening::TcpOpening(asio::io_context& io, PortListener& listener, Target target)
    : PortOpening(io, listener), target_(std::move(target)), names_(io), socket_(io), limit_(io) {}

void TcpOpening::begin() {
  limit_.expires_after(target_.timeout);
  limit_.async_wait([self = self_as<TcpOpening>()](boost::system::error_code fault) {
    if (!self->over_ && !self->connected_ && !fault)
      self->give_up((self->tls_ ? "no TLS handshake within " : "no connection within ") +
                    to_text(self->target_.timeout));
  });
  names_.start(target_.host, [self = self_as<TcpOpening>()](const NameLookup::Found& found) {
    if (self->over_) return;
    found ? self->connect(*found) : self->give_up(found.error());
  });
}

void TcpOpening::connect(const std::vector<asio::ip::address>& addresses) {
  std::vector<tcp::endpoint> endpoints;
  for (const asio::ip::address& address : addresses) endpoints.emplace_back(address, target_.port);
  asio::async_connect(
      socket_, endpoints,
      [self = self_as<TcpOpening>()](boost::system::error_code fault, const tcp::endpoint&) {
        if (self->over_) return;
        if (fault) return self->give_up(self->with_fence(fault.message()));
        self->target_.tls ? self->start_tls() : self->finish();
      });
}

void TcpOpening::start_tls() {
  auto tls = TlsEngine::make(*target_.tls, target_.certified_name);
  if (!tls) return give_up("TLS: " + tls.error());
  tls_ = std::move(*tls);
  shake_hands({});
}

void TcpOpening::shake_hands(ByteView received) {
  Bytes none;
  sending_.clear();
  const bool open = tls_->receive(received, none, sending_);
  if (sending_.empty()) return shaken(open);
  asio::async_write(socket_, asio::buffer(sending_),
                    [self = self_as<TcpOpening>(), open](boost::system::error_code fault, auto) {
                      if (self->over_) return;
                      if (fault && open) return self->give_up("TLS: " + fault.message());
                      self->shaken(open);
                    });
}

// What was to be sent is sent.
void TcpOpening::shaken(bool open) {
  if (!open) return give_up(tls_->fault());
  if (tls_->ready()) return finish();
  socket_.async_read_some(
      asio::buffer(received_),
      [self = self_as<TcpOpening>()](boost::system::error_code fault, std::size_t size) {
        if (self->over_) return;
        if (!fault) return self->shake_hands(ByteView(self->received_).first(size));
        self->give_up(fault == asio::error::eof
                          ? "TLS: the server closed the connection during the handshake"
                          : "TLS: " + fault.message());
      });
}

void TcpOpening::finish() {
  connected_ = true;
  limit_.cancel();
  boost::system::error_code fault;
  FileDescriptor socket(socket_.release(fault));
  if (fault) return give_up("the connection is closed already");
  connected(std::move(socket), std::move(tls_));
}

std::string TcpOpening::with_fence(std::string reason) const {
  if (!target_.one_client) return reason;
  return reason + " (it accepts one client: another client may be connected)";
}

void TcpOpening::cancel() {
  limit_.cancel();
  names_.cancel();
  boost::system::error_code ignored;
  socket_.close(ignored);
}

}  // namespace fieldcast
