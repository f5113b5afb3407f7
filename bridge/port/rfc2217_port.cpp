#include "bridge/port/rfc2217_port.hpp"

#include <boost/asio/io_context.hpp>

#include "bridge/port/tcp_opening.hpp"
#include "bridge/port/telnet_line.hpp"

namespace fieldcast {
namespace {

namespace asio = boost::asio;

class Rfc2217Stream final : public Stream {
 public:
  Rfc2217Stream(asio::io_context& io, PortListener& listener, std::shared_ptr<TelnetLine> line)
      : Stream(io, listener, Unsent::Kind::kSocket), line_(std::move(line)) {}
  ~Rfc2217Stream() override { close(); }

 private:
  void fetch() override { line_->turn(); }
  // A new connection sets the line again.
  std::optional<End> restore(int) override {
    if (!line_->changed()) return std::nullopt;
    return End{"an engineer has set the line; it is opened with the settings of the bus"};
  }
  End end_of(int error) const override {
    return {line_->reason().empty() ? errno_text(error) : line_->reason()};
  }
  void before_close(int) override { line_->close(); }

  const std::shared_ptr<TelnetLine> line_;
};

class Rfc2217Opening final : public TcpOpening {
 public:
  Rfc2217Opening(asio::io_context& io, const Rfc2217PortSpec& spec, PortListener& listener)
      : TcpOpening(io, listener,
                   {spec.host, spec.port, spec.connect_timeout, spec.fence.is(Fence::kOneClient)}),
        format_(spec.line) {}

  [[nodiscard]] const std::shared_ptr<TelnetLine>& line() const { return line_; }

 private:
  void connected(FileDescriptor socket, std::unique_ptr<TlsEngine>) override {
    tune_socket(socket.get(), target().one_client ? kUnacknowledgedByOne : kUnacknowledged);
    line_ = std::make_shared<TelnetLine>(io_, std::move(socket), format_);
    const auto self = self_as<Rfc2217Opening>();
    line_->start({[self](FileDescriptor end) { self->line_opened(std::move(end)); },
                  [self](Stream::End end) { self->fail(std::move(end.reason), end.cause); }});
  }

  void line_opened(FileDescriptor end) {
    auto stream = std::make_shared<Rfc2217Stream>(io_, listener_, line_);
    if (!stream->assign(std::move(end))) return give_up("the line cannot be waited for");
    opened(std::move(stream));
  }

  void cancel() override {
    TcpOpening::cancel();
    if (line_) line_->close();
  }

  const LineFormat format_;
  std::shared_ptr<TelnetLine> line_;
};

}  // namespace

void Rfc2217Port::change_line(const telnet::LineChange& change,
                              const telnet::LineChangeDone& done) {
  const auto line = opening_ ? static_cast<Rfc2217Opening&>(*opening_).line() : nullptr;
  line ? line->change(change, done) : done({});
}

std::shared_ptr<PortOpening> Rfc2217Port::make_opening(PortListener& listener) {
  return std::make_shared<Rfc2217Opening>(io_, spec_, listener);
}

}  // namespace fieldcast
