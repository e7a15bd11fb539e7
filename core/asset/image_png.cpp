// PNG files read through libpng (png_encoder.cpp writes them). It reports errors by longjmp, which must not cross C++
// objects with destructors: all that is allocated lives in the caller's structs, and the functions that libpng jumps
// out of hold only plain values.
#include <png.h>

#include <csetjmp>
#include <cstring>
#include <vector>

#include "core/asset/image_codec.h"
#include "core/asset/image_formats.h"
#include "core/error.h"

namespace orbis::asset {
namespace {

struct Reader {
  std::span<const std::byte> bytes;
  std::size_t position = 0;
  png_structp png = nullptr;
  png_infop info = nullptr;

  explicit Reader(std::span<const std::byte> input) : bytes(input) {}
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;
  ~Reader() { png_destroy_read_struct(&png, &info, nullptr); }
};

// In place of libpng's own handlers, which print.
[[noreturn]] void jump_back(png_structp png, png_const_charp) { png_longjmp(png, 1); }
void no_warning(png_structp, png_const_charp) {}

void read_bytes(png_structp png, png_bytep out, std::size_t count) {
  auto& reader = *static_cast<Reader*>(png_get_io_ptr(png));
  if (count > reader.bytes.size() - reader.position) png_error(png, "truncated");
  std::memcpy(out, reader.bytes.data() + reader.position, count);
  reader.position += count;
}

// Everything to 8-bit RGB or RGBA. False where the header is damaged.
bool read_header(Reader& reader) {
  if (setjmp(png_jmpbuf(reader.png)) != 0) return false;
  png_set_read_fn(reader.png, &reader, read_bytes);
  // Text and colour profiles are not wanted: they may be compressed bombs.
  png_set_keep_unknown_chunks(reader.png, PNG_HANDLE_CHUNK_NEVER, nullptr, 0);
  png_set_chunk_malloc_max(reader.png, 1U << 20U);
  png_set_user_limits(reader.png, 1U << 20U, 1U << 20U);
  png_read_info(reader.png, reader.info);
  return true;
}

bool set_transforms(Reader& reader) {
  if (setjmp(png_jmpbuf(reader.png)) != 0) return false;
  png_set_expand(reader.png); // palette to RGB, gray to 8 bits, tRNS to alpha
  png_set_scale_16(reader.png);
  png_set_gray_to_rgb(reader.png);
  png_set_interlace_handling(reader.png);
  png_read_update_info(reader.png, reader.info);
  return true;
}

bool read_rows(Reader& reader, png_bytepp rows) {
  if (setjmp(png_jmpbuf(reader.png)) != 0) return false;
  png_read_image(reader.png, rows);
  return true;
}

} // namespace

texture::Image decode_png(const ImageRequest& request) {
  Reader reader(request.bytes);
  reader.png = png_create_read_struct(PNG_LIBPNG_VER_STRING, nullptr, jump_back, no_warning);
  if (reader.png != nullptr) reader.info = png_create_info_struct(reader.png);
  if (reader.info == nullptr) throw Error(ErrorCode::out_of_memory, "there is no memory to decode an image");
  if (!read_header(reader)) request.refuse("is damaged: its PNG header cannot be read");
  request.check_size(png_get_image_width(reader.png, reader.info), png_get_image_height(reader.png, reader.info));
  if (!set_transforms(reader)) request.refuse("is damaged: its PNG header cannot be read");

  texture::Image image{png_get_image_width(reader.png, reader.info),
                       png_get_image_height(reader.png, reader.info),
                       png_get_channels(reader.png, reader.info),
                       {}};
  const std::size_t row_bytes = png_get_rowbytes(reader.png, reader.info);
  if (row_bytes != std::size_t{image.width} * image.channels) request.refuse("has an unknown PNG pixel format");
  image.pixels.resize(row_bytes * image.height);
  std::vector<png_bytep> rows(image.height);
  for (std::uint32_t y = 0; y < image.height; ++y) rows[y] = image.at(0, y);
  if (!read_rows(reader, rows.data())) request.refuse("is damaged: its PNG data cannot be decoded");
  return image;
}

} // namespace orbis::asset
