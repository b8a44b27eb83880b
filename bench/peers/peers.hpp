// SPDX-License-Identifier: BSD-3-Clause
// What a peer codec is to the programs that measure it: something that takes a cloud and a setting,
// and returns the size of a real stream and what its own decoder made of it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <ctime>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "curlidar/cloud.hpp"
#include "curlidar/result.hpp"
#include "curlidar/sensor.hpp"

namespace curlidar::bench {

using Bytes = std::vector<std::byte>;

/// Which cells hold a return.
struct Mask {
  std::size_t rows = 0, columns = 0;
  std::vector<std::uint8_t> occupied;  ///< rows x columns, raster order, 0 or 1
};

/// The gridded cloud that every codec is given: one return for each occupied cell.
struct Grid {
  Mask mask;
  Cloud returns;                 ///< the occupied cells' points in raster order
  std::vector<double> ranges_m;  ///< their distances from the sensor
};

/// The slots that hold a return, in their order.
Cloud returns_of(const Cloud& cloud);

/// An organised cloud as `curlidar project` writes it. An error if nothing is occupied.
Result<Grid> make_grid(const Cloud& cloud, const std::string& name);

/// A raw scan, every range, on a row for each ring (radially on cell centres). Unlike `project`, a
/// row is a cone z = height + slope * distance, fitted, since beams do not start at the origin, and
/// its columns are turned to where most of its returns lie: both save a range image centimetres of
/// error, and its decoder gets these three numbers of a row for nothing. Returns that share a cell
/// with one nearer its centre are lost. `found` is what detect_sensor says of this cloud.
Grid ring_image(const Cloud& cloud, const Detection& found, std::size_t columns);

/// How a decoded cloud lies beside the coded one.
enum class Order {
  ranges,   ///< same cells in the same order, only ranges differ
  points,   ///< same points in the same order
  unknown,  ///< reordered, or with points lost
};

/// CPU time of this process since the last lap. The codecs run on one thread.
class CpuTimer {
 public:
  double lap_ms() {
    const std::clock_t last = std::exchange(at_, std::clock());
    return 1e3 * static_cast<double>(at_ - last) / CLOCKS_PER_SEC;
  }

 private:
  std::clock_t at_ = std::clock();
};

struct Decoded {
  std::size_t bytes = 0;                ///< of everything the decoder needs
  double encode_ms = 0, decode_ms = 0;  ///< CPU, without conversions between cloud types
  Cloud cloud;
  Order order = Order::unknown;
};

/// One curve: a codec and the settings it is swept over.
struct Peer {
  std::string name;
  std::string setting;  ///< what the swept number is, with its unit
  std::vector<double> sweep;
  std::function<Result<Decoded>(const Grid&, double)> run;
};

/// A lossless coder of 16-bit images, rows x columns samples in raster order. Both sides know the
/// mask; what unpack gives back matters in occupied cells only.
struct ImageCoder {
  using Samples = std::vector<std::uint16_t>;
  std::string name;
  std::function<Result<Bytes>(const Samples&, const Mask&)> pack;
  std::function<Result<Samples>(const Bytes&, const Mask&)> unpack;
};

// mask_coder.cpp: an adaptive binary range coder whose context is ten known neighbours. Real bytes.
Bytes pack_mask(const Mask& mask);
Mask unpack_mask(const Bytes& bytes, std::size_t rows, std::size_t columns);

// range_image.cpp: ranges in steps of the sweep (metres), holes filled from their neighbours, coded
// by `coder`; plus the mask. The decoder is given row elevations and the step for nothing.
Peer range_image_peer(ImageCoder coder);

ImageCoder png_coder();   // png_peer.cpp: 16-bit grey, level 9, filters chosen row by row
ImageCoder zstd_coder();  // zstd_peer.cpp: differences of occupied cells, zstd level 19
Peer zstd_delta_peer();   // zstd_peer.cpp: x, y, z in steps, differences, zstd level 19
// Only where the libraries were found (CURLIDAR_BENCH_HAS_JXL, _DRACO, _PCL):
ImageCoder jxl_coder();  // jxl_peer.cpp: JPEG XL, lossless, effort 9
Peer draco_peer();       // draco_peer.cpp: kd-tree, speed 0
Peer pcl_octree_peer();  // pcl_peer.cpp: one point for each voxel

/// At most `count` settings of a sweep, its ends and what lies evenly between; 0 = all.
std::vector<double> thinned(const std::vector<double>& sweep, std::size_t count);

/// All of them. Those whose library was not found when this was built have nothing to run.
std::vector<Peer> all_peers();

}  // namespace curlidar::bench
