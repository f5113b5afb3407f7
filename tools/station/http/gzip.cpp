#include "tools/station/http/gzip.hpp"

#include <zlib.h>

#include "bridge/base/check.hpp"

namespace fieldcast::web {
namespace {

constexpr int kGzip = 15 + 16;  // the largest window; + 16 selects the gzip header
constexpr std::size_t kPiece = 32 * 1024;

}  // namespace

struct GzipPieces::State {
  State() {
    FIELDCAST_CHECK(deflateInit2(&stream, Z_BEST_SPEED, Z_DEFLATED, kGzip, 8, Z_DEFAULT_STRATEGY) ==
                    Z_OK);
  }
  ~State() { deflateEnd(&stream); }
  State(const State&) = delete;
  State& operator=(const State&) = delete;

  std::string run(std::string_view text, int flush) {
    std::string out;
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(text.data()));
    stream.avail_in = static_cast<uInt>(text.size());
    do {
      const std::size_t had = out.size();
      out.resize(had + kPiece);
      stream.next_out = reinterpret_cast<Bytef*>(out.data() + had);
      stream.avail_out = kPiece;
      deflate(&stream, flush);
      out.resize(out.size() - stream.avail_out);
    } while (stream.avail_out == 0);
    return out;
  }

  z_stream stream{};
};

GzipPieces::GzipPieces() : state_(std::make_unique<State>()) {}
GzipPieces::~GzipPieces() = default;
std::string GzipPieces::put(std::string_view text) { return state_->run(text, Z_NO_FLUSH); }
std::string GzipPieces::finish() { return state_->run({}, Z_FINISH); }

std::string packed(std::string_view text) {
  GzipPieces pieces;
  std::string out = pieces.put(text);
  out += pieces.finish();
  return out;
}

std::string unpacked(std::string_view gzip) {
  z_stream stream{};
  FIELDCAST_CHECK(inflateInit2(&stream, kGzip) == Z_OK);
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(gzip.data()));
  stream.avail_in = static_cast<uInt>(gzip.size());
  std::string out;
  for (int code = Z_OK; code == Z_OK;) {
    const std::size_t had = out.size();
    out.resize(had + kPiece);
    stream.next_out = reinterpret_cast<Bytef*>(out.data() + had);
    stream.avail_out = kPiece;
    code = inflate(&stream, Z_NO_FLUSH);
    out.resize(out.size() - stream.avail_out);
  }
  inflateEnd(&stream);
  return out;
}

}  // namespace fieldcast::web
