#include "bridge/capture/capture_service.hpp"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <future>
#include <list>
#include <map>

#include "bridge/base/clock.hpp"
#include "bridge/base/io_thread.hpp"
#include "bridge/capture/capture_client.hpp"
#include "bridge/capture/capture_ring.hpp"
#include "bridge/capture/capture_socket.hpp"
#include "bridge/log/log.hpp"

namespace fieldcast {
namespace {

namespace asio = boost::asio;
using Local = asio::local::stream_protocol;

constexpr int kNiceness = 10;
constexpr std::chrono::milliseconds kPatience{500};  // maximum wait for a disk that hangs

}  // namespace

class CaptureService::Loop final : public std::enable_shared_from_this<Loop> {
 public:
  Loop(asio::io_context& io, std::string bridge)
      : bridge_(std::move(bridge)), acceptor_(io), turning_(io) {}

  void start() {
    ::setpriority(PRIO_PROCESS, static_cast<id_t>(::gettid()), kNiceness);
    listen();
  }

  void add(const BusSpec& spec, const std::shared_ptr<CaptureTap>& tap) {
    Bus& bus = buses_[spec.name];
    bus.capture = std::make_unique<BusCapture>(spec, "bridge " + bridge_, tap);
    configure(spec.name, spec.capture);
  }

  void configure(const std::string& name, const std::optional<CaptureSpec>& spec) {
    const auto found = buses_.find(name);
    if (found == buses_.end()) return;
    Bus& bus = found->second;
    if (bus.ring ? spec && bus.ring->spec() == *spec : !spec) return;
    if (bus.ring) {
      bus.capture->drain(read_clocks().utc);
      bus.capture->remove(*bus.ring);
      bus.ring.reset();
    }
    if (!spec) return;
    bus.ring = std::make_unique<CaptureRing>(
        name, *spec,
        [capture = bus.capture.get()](const std::string& remark) { return capture->head(remark); });
    bus.capture->add(*bus.ring);
    turn_soon();
  }

  void remove(const std::string& name, const std::string& why) {
    const auto found = buses_.find(name);
    if (found == buses_.end()) return;
    const UtcTime now = read_clocks().utc;
    found->second.capture->finish(now);
    // A copy: end() may call gone(), which removes the client from the list.
    const auto clients = clients_;
    for (const auto& client : clients) {
      if (client->bus() == name) client->end(why, now);
    }
    buses_.erase(found);
  }

  // `done` is called when the last client is closed.
  void stop(std::function<void()> done) {
    while (!buses_.empty()) remove(std::string(buses_.begin()->first), "the bridge ended");
    boost::system::error_code ignored;
    acceptor_.close(ignored);
    turning_.cancel();
    if (clients_.empty()) return done();
    stopped_ = std::move(done);
  }

 private:
  struct Bus {
    std::unique_ptr<BusCapture> capture;
    std::unique_ptr<CaptureRing> ring;
  };

  void listen() {
    const std::string name = capture_socket_name(::geteuid(), bridge_, ::getpid());
    try {
      acceptor_.open();
      acceptor_.bind(Local::endpoint('\0' + name));
      acceptor_.listen();
    } catch (const boost::system::system_error& error) {
      log_warning("capture", fmt::format("'fieldcast capture' cannot reach this bridge: {}",
                                         error.code().message()));
      return;
    }
    accept();
  }

  void accept() {
    acceptor_.async_accept(
        [self = shared_from_this()](boost::system::error_code error, Local::socket socket) {
          if (error == asio::error::operation_aborted || !self->acceptor_.is_open()) return;
          if (!error) self->came(std::move(socket));
          self->accept();
        });
  }

  void came(Local::socket socket) {
    const auto user = peer_user(socket.native_handle());
    const bool allowed = user && (*user == 0 || *user == ::geteuid());
    if (!allowed) {
      log_counted(LogLevel::kWarning, "capture", "refused captures",
                  fmt::format("refused: user {} is neither root nor the one of the bridge",
                              user ? std::to_string(*user) : "?"));
    }
    // Refused users occupy a place until their request: they leave most places free.
    if (clients_.size() >= (allowed ? kMaxClients : kMaxRefused)) return;  // destroys the socket
    auto client = std::make_shared<CaptureClient>(
        std::move(socket),
        [weak = weak_from_this(), allowed](CaptureClient& asking, const std::string& request) {
          if (const auto self = weak.lock()) self->asked(asking, request, allowed);
        },
        [weak = weak_from_this()](CaptureClient& gone) {
          if (const auto self = weak.lock()) self->gone(gone);
        });
    clients_.push_back(client);
    client->start();
  }

  void asked(CaptureClient& client, const std::string& request, bool allowed) {
    static constexpr std::string_view kCapture = "capture ";
    std::string names;
    for (const auto& [name, bus] : buses_) names += ' ' + name;
    if (!allowed) return client.reply("refused only root and the user of the bridge may");
    if (request == "list") return client.reply(fmt::format("ok bridge {} buses{}", bridge_, names));
    if (!request.starts_with(kCapture)) return client.reply("refused nobody understands that");
    const auto found = buses_.find(request.substr(kCapture.size()));
    if (found == buses_.end()) return client.reply("no" + names);
    BusCapture& capture = *found->second.capture;
    capture.drain(read_clocks().utc);  // earlier records are not for this client
    capture.add(client);
    client.begin(found->first, capture.head(), read_clocks().utc);
    log_info(found->first, "captured by 'fieldcast capture'");
    turn_soon();
  }

  void gone(CaptureClient& client) {
    if (const auto found = buses_.find(client.bus()); found != buses_.end()) {
      found->second.capture->remove(client);
      log_info(found->first, "'fieldcast capture' ended");
    }
    std::erase_if(clients_, [&](const auto& each) { return each.get() == &client; });
    if (!clients_.empty()) return;
    if (const auto done = std::exchange(stopped_, {})) done();
  }

  // The timer runs only during a capture.
  void turn_soon() {
    if (std::exchange(turns_, true)) return;
    turning_.expires_after(kTurn);
    turning_.async_wait([self = shared_from_this()](boost::system::error_code cancelled) {
      self->turns_ = false;
      if (!cancelled) self->turn();
    });
  }

  void turn() {
    const UtcTime now = read_clocks().utc;
    bool busy = false;
    for (auto& [name, bus] : buses_) {
      if (!bus.capture->busy()) continue;
      busy = true;
      bus.capture->drain(now);
      if (bus.ring) bus.ring->look(now);
    }
    if (busy) turn_soon();
  }

  const std::string bridge_;
  Local::acceptor acceptor_;
  asio::steady_timer turning_;
  std::map<std::string, Bus> buses_;
  std::list<std::shared_ptr<CaptureClient>> clients_;
  std::function<void()> stopped_;  // set while the last clients are served
  bool turns_ = false;
};

CaptureService::CaptureService(const std::string& bridge)
    : io_(std::make_unique<IoThread>("capture")),
      loop_(std::make_shared<Loop>(io_->context(), bridge)) {
  asio::post(io_->context(), [loop = loop_] { loop->start(); });
}

CaptureService::~CaptureService() {
  run([loop = loop_](const std::function<void()>& done) { loop->stop(done); });
  loop_.reset();  // before the context that it uses
}

std::shared_ptr<CaptureTap> CaptureService::add_bus(const BusSpec& bus) {
  auto tap = std::make_shared<CaptureTap>();
  asio::post(io_->context(), [loop = loop_, bus, tap] { loop->add(bus, tap); });
  return tap;
}

void CaptureService::remove_bus(const std::string& name) {
  run([loop = loop_, name](const std::function<void()>& done) {
    loop->remove(name, "the bus ended");
    done();
  });
}

void CaptureService::configure(const std::string& name, const std::optional<CaptureSpec>& spec) {
  asio::post(io_->context(), [loop = loop_, name, spec] { loop->configure(name, spec); });
}

// Waits for `work`, at most kPatience if a disk hangs.
void CaptureService::run(const std::function<void(const std::function<void()>& done)>& work) {
  auto done = std::make_shared<std::promise<void>>();
  auto ready = done->get_future();
  asio::post(io_->context(), [work, done] { work([done] { done->set_value(); }); });
  (void)ready.wait_for(kPatience);
}

}  // namespace fieldcast
