// SPDX-License-Identifier: BSD-3-Clause
#include "paper/delaunay.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <utility>

namespace curlidar {
namespace {

__extension__ typedef __int128 Int128;

int sign_of(std::int64_t v) {
  return (v > 0) - (v < 0);
}

/// Directed edges in groups of four (an edge, its dual, and their reverses). Only the two primal
/// ones of each group carry an origin.
class QuadEdges {
 public:
  using Edge = std::uint32_t;

  explicit QuadEdges(std::size_t points) {
    next_.reserve(points * 12);
    origin_.reserve(points * 12);
    dead_.reserve(points * 3);
  }

  static Edge rot(Edge e) { return (e & ~3u) | ((e + 1) & 3u); }
  static Edge sym(Edge e) { return e ^ 2u; }
  static Edge inv_rot(Edge e) { return (e & ~3u) | ((e + 3) & 3u); }

  Edge onext(Edge e) const { return next_[e]; }
  Edge oprev(Edge e) const { return rot(next_[rot(e)]); }
  Edge lnext(Edge e) const { return rot(next_[inv_rot(e)]); }
  Edge rprev(Edge e) const { return next_[sym(e)]; }
  std::uint32_t org(Edge e) const { return origin_[e]; }
  std::uint32_t dest(Edge e) const { return origin_[sym(e)]; }
  bool dead(Edge e) const { return dead_[e >> 2]; }
  std::size_t size() const { return next_.size(); }

  Edge make(std::uint32_t from, std::uint32_t to) {
    const auto e = static_cast<Edge>(next_.size());
    next_.insert(next_.end(), {e, e + 3, e + 2, e + 1});
    origin_.insert(origin_.end(), {from, 0u, to, 0u});
    dead_.push_back(false);
    return e;
  }
  void splice(Edge a, Edge b) {
    const Edge alpha = rot(next_[a]);
    const Edge beta = rot(next_[b]);
    std::swap(next_[a], next_[b]);
    std::swap(next_[alpha], next_[beta]);
  }
  Edge connect(Edge a, Edge b) {
    const Edge e = make(dest(a), org(b));
    splice(e, lnext(a));
    splice(sym(e), b);
    return e;
  }
  void remove(Edge e) {
    splice(e, oprev(e));
    splice(sym(e), oprev(sym(e)));
    dead_[e >> 2] = true;
  }

 private:
  std::vector<Edge> next_;
  std::vector<std::uint32_t> origin_;
  std::vector<bool> dead_;
};

class DivideAndConquer {
 public:
  using Edge = QuadEdges::Edge;

  DivideAndConquer(const std::vector<GridPoint>& points, const std::vector<std::uint32_t>& order)
      : points_(points), order_(order), edges_(points.size()) {}

  void run() { build(0, order_.size()); }

  /// Faces with three edges, wound counter-clockwise.
  Triangulation triangles() const {
    Triangulation out;
    std::vector<std::uint32_t> half_edge_of(edges_.size(), kNoTwin);
    for (Edge e = 0; e < edges_.size(); e += 2) {
      if (edges_.dead(e) || half_edge_of[e] != kNoTwin) continue;
      const Edge b = edges_.lnext(e), c = edges_.lnext(b);
      if (edges_.lnext(c) != e || !ccw(edges_.org(e), edges_.org(b), edges_.org(c))) continue;
      for (const Edge side : {e, b, c}) {
        half_edge_of[side] = static_cast<std::uint32_t>(out.corner.size());
        out.corner.push_back(edges_.org(side));
      }
    }
    out.twin.assign(out.corner.size(), kNoTwin);
    for (Edge e = 0; e < edges_.size(); e += 2) {
      if (half_edge_of[e] != kNoTwin) out.twin[half_edge_of[e]] = half_edge_of[QuadEdges::sym(e)];
    }
    return out;
  }

 private:
  /// Leftmost and rightmost hull edges of a triangulated run of points.
  struct Hull {
    Edge left, right;
  };

  bool ccw(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
    return orientation(points_[a], points_[b], points_[c]) > 0;
  }
  bool right_of(std::uint32_t p, Edge e) const { return ccw(p, edges_.dest(e), edges_.org(e)); }
  bool left_of(std::uint32_t p, Edge e) const { return ccw(p, edges_.org(e), edges_.dest(e)); }
  bool inside(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) const {
    return in_circle(points_[a], points_[b], points_[c], points_[d]) > 0;
  }

  Hull build(std::size_t begin, std::size_t end) {
    if (end - begin == 2) {
      const Edge a = edges_.make(order_[begin], order_[begin + 1]);
      return {a, QuadEdges::sym(a)};
    }
    if (end - begin == 3) return build_three(begin);
    const std::size_t middle = begin + (end - begin) / 2;
    const Hull left = build(begin, middle);
    const Hull right = build(middle, end);
    return merge(left, right);
  }

  Hull build_three(std::size_t begin) {
    const std::uint32_t s1 = order_[begin], s2 = order_[begin + 1], s3 = order_[begin + 2];
    const Edge a = edges_.make(s1, s2), b = edges_.make(s2, s3);
    edges_.splice(QuadEdges::sym(a), b);
    if (ccw(s1, s2, s3)) {
      edges_.connect(b, a);
      return {a, QuadEdges::sym(b)};
    }
    if (ccw(s1, s3, s2)) {
      const Edge c = edges_.connect(b, a);
      return {QuadEdges::sym(c), c};
    }
    return {a, QuadEdges::sym(b)};
  }

  Hull merge(Hull left, Hull right) {
    Edge ldo = left.left, ldi = left.right, rdi = right.left, rdo = right.right;
    for (;;) {  // lower common tangent
      if (left_of(edges_.org(rdi), ldi)) {
        ldi = edges_.lnext(ldi);
      } else if (right_of(edges_.org(ldi), rdi)) {
        rdi = edges_.rprev(rdi);
      } else {
        break;
      }
    }
    Edge base = edges_.connect(QuadEdges::sym(rdi), ldi);
    if (edges_.org(ldi) == edges_.org(ldo)) ldo = QuadEdges::sym(base);
    if (edges_.org(rdi) == edges_.org(rdo)) rdo = base;
    for (;;) {  // rising bubble
      const Edge lcand = left_candidate(base), rcand = right_candidate(base);
      const bool lvalid = right_of(edges_.dest(lcand), base);
      const bool rvalid = right_of(edges_.dest(rcand), base);
      if (!lvalid && !rvalid) break;
      if (!lvalid || (rvalid && inside(edges_.dest(lcand), edges_.org(lcand), edges_.org(rcand),
                                       edges_.dest(rcand)))) {
        base = edges_.connect(rcand, QuadEdges::sym(base));
      } else {
        base = edges_.connect(QuadEdges::sym(base), QuadEdges::sym(lcand));
      }
    }
    return {ldo, rdo};
  }

  Edge left_candidate(Edge base) {
    Edge candidate = edges_.onext(QuadEdges::sym(base));
    if (right_of(edges_.dest(candidate), base)) {
      while (inside(edges_.dest(base), edges_.org(base), edges_.dest(candidate),
                    edges_.dest(edges_.onext(candidate)))) {
        const Edge next = edges_.onext(candidate);
        edges_.remove(candidate);
        candidate = next;
      }
    }
    return candidate;
  }

  Edge right_candidate(Edge base) {
    Edge candidate = edges_.oprev(base);
    if (right_of(edges_.dest(candidate), base)) {
      while (inside(edges_.dest(base), edges_.org(base), edges_.dest(candidate),
                    edges_.dest(edges_.oprev(candidate)))) {
        const Edge next = edges_.oprev(candidate);
        edges_.remove(candidate);
        candidate = next;
      }
    }
    return candidate;
  }

  const std::vector<GridPoint>& points_;
  const std::vector<std::uint32_t>& order_;
  QuadEdges edges_;
};

}  // namespace

int orientation(const GridPoint& a, const GridPoint& b, const GridPoint& c) {
  const std::int64_t abx = std::int64_t{b.x} - a.x, aby = std::int64_t{b.y} - a.y;
  const std::int64_t acx = std::int64_t{c.x} - a.x, acy = std::int64_t{c.y} - a.y;
  return sign_of(abx * acy - aby * acx);
}

int in_circle(const GridPoint& a, const GridPoint& b, const GridPoint& c, const GridPoint& d) {
  const std::int64_t adx = std::int64_t{a.x} - d.x, ady = std::int64_t{a.y} - d.y;
  const std::int64_t bdx = std::int64_t{b.x} - d.x, bdy = std::int64_t{b.y} - d.y;
  const std::int64_t cdx = std::int64_t{c.x} - d.x, cdy = std::int64_t{c.y} - d.y;
  const std::int64_t bc = bdx * cdy - bdy * cdx, ca = cdx * ady - cdy * adx,
                     ab = adx * bdy - ady * bdx;
  const std::int64_t a2 = adx * adx + ady * ady, b2 = bdx * bdx + bdy * bdy,
                     c2 = cdx * cdx + cdy * cdy;
  // Doubles settle nearly all cases; each of the three products is off by less than 4 eps.
  const double da = static_cast<double>(a2) * static_cast<double>(bc);
  const double db = static_cast<double>(b2) * static_cast<double>(ca);
  const double dc = static_cast<double>(c2) * static_cast<double>(ab);
  const double sum = da + db + dc;
  const double bound =
      8 * std::numeric_limits<double>::epsilon() * (std::abs(da) + std::abs(db) + std::abs(dc));
  if (sum > bound) return 1;
  if (sum < -bound) return -1;
  const Int128 exact = Int128{a2} * bc + Int128{b2} * ca + Int128{c2} * ab;
  return (exact > 0) - (exact < 0);
}

Triangulation delaunay(const std::vector<GridPoint>& points) {
  if (points.size() < 3) return {};
  std::vector<std::uint32_t> order(points.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(),
            [&](std::uint32_t a, std::uint32_t b) { return points[a] < points[b]; });
  DivideAndConquer work(points, order);
  work.run();
  return work.triangles();
}

}  // namespace curlidar
