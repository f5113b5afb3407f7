#include "tools/forward/outlet/influxdb/gzip.hpp"

#include <zlib.h>

#include <new>

namespace fieldcast::forward {

std::string gzipped(const std::string& text) {
  constexpr int kGzip = 15 + 16;  // the largest window, with the header of gzip
  constexpr int kMemory = 8;      // the default
  z_stream stream{};
  if (deflateInit2(&stream, Z_BEST_SPEED, Z_DEFLATED, kGzip, kMemory, Z_DEFAULT_STRATEGY) != Z_OK)
    throw std::bad_alloc();
  std::string packed(deflateBound(&stream, text.size()), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(text.data()));
  stream.avail_in = static_cast<uInt>(text.size());
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_out = static_cast<uInt>(packed.size());
  deflate(&stream, Z_FINISH);  // the bound is large enough
  packed.resize(stream.total_out);
  deflateEnd(&stream);
  return packed;
}

}  // namespace fieldcast::forward
