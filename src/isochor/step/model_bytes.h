// The fields of the patch model and of the solid model, listed for bytes.h.
#pragma once

#include "isochor/step/bytes.h"
#include "isochor/step/solid_model.h"

namespace isochor {

template <typename Io>
void transfer(Io& io, Uv& f) {
  io(f.u, f.v);
}
template <typename Io>
void transfer(Io& io, UvBox& f) {
  io(f.u_min, f.u_max, f.v_min, f.v_max);
}
template <typename Io>
void transfer(Io& io, TrimRegion& f) {
  io(f.boundary, f.loops);
}
template <typename Io>
void transfer(Io& io, SideRef& f) {
  io(f.patch, f.side);
}
template <typename Io>
void transfer(Io& io, SidePart& f) {
  io(f.from, f.to);
}
template <typename Io>
void transfer(Io& io, Join& f) {
  io(f.a, f.b, f.part_a, f.part_b, f.opposed, f.matching, f.mismatch, f.common, f.max_gap,
     f.max_angle_rad, f.max_curvature_jump, f.smoothness);
}
template <typename Io>
void transfer(Io& io, LockedSide& f) {
  io(f.side, f.reason, f.smoothness, f.part);
}
template <typename Io>
void transfer(Io& io, SharedTrim& f) {
  io(f.patches, f.along, f.boxes, f.locked_sides, f.corners, f.smoothness, f.released);
}
template <typename Io>
void transfer(Io& io, Lock& f) {
  io(f.point, f.reason);
}
template <typename Io>
void transfer(Io& io, LockReason& f) {
  io(f.text, f.continuity, f.join);
}
template <typename Io>
void transfer(Io& io, LineTerm& f) {
  io(f.strip, f.row, f.value);
}
template <typename Io>
void transfer(Io& io, SmoothRelation& f) {
  io(f.kind, f.join, f.patch, f.across, f.knot, f.sides, f.order, f.lambda, f.mu, f.residual,
     f.text, f.equations);
}
template <typename Io>
void transfer(Io& io, PatchModel& f) {
  io(f.unit, f.points, f.patches, f.ties, f.joins, f.locked_sides, f.fixed_points, f.shared_trims,
     f.lock_reasons, f.locks, f.relations);
}
template <typename Io>
void transfer(Io& io, FaceFacts& f) {
  io(f.handle, f.name, f.aliases, f.surface, f.trim, f.bspline, f.rational, f.convertible, f.patch,
     f.not_editable, f.area, f.flux, f.flux_bound, f.tolerance);
}
template <typename Io>
void transfer(Io& io, EdgeFacts& f) {
  io(f.faces, f.degenerated, f.length, f.tolerance, f.max_gap, f.max_angle_rad, f.smoothness,
     f.points, f.entity);
}
template <typename Io>
void transfer(Io& io, ShapeFacts& f) {
  io(f.valid, f.defects, f.solids, f.shells, f.closed_shells, f.free_edges, f.multiple_edges,
     f.closed, f.max_tolerance, f.max_edge_gap, f.max_vertex_gap, f.area, f.volume, f.volume_bound,
     f.diagonal, f.names, f.coloured);
}
template <typename Io>
void transfer(Io& io, OpenEdge& f) {
  io(f.label, f.points);
}
template <typename Io>
void transfer(Io& io, MomentIntegrals& f) {
  io(f.origin, f.value, f.bound);
}
template <typename Io>
void transfer(Io& io, Section& f) {
  io(f.normal, f.height, f.area, f.bound, f.centroid, f.centroid_bound, f.coplanar);
}
template <typename Io>
void transfer(Io& io, PartBelow& f) {
  io(f.normal, f.height, f.side, f.volume, f.bound, f.centroid, f.centroid_bound, f.proven);
}
template <typename Io>
void transfer(Io& io, ShapeCounts& f) {
  io(f.solids, f.shells, f.faces);
}
template <typename Io>
void transfer(Io& io, SewingAccount& f) {
  io(f.done, f.declined, f.tolerance, f.faces, f.shells, f.solids, f.free_edges_before,
     f.free_edges_after, f.dropped, f.turned);
}
template <typename Io>
void transfer(Io& io, ImportAccount& f) {
  io(f.has_text, f.entities, f.error_entities, f.roots, f.junk_bytes, f.stated, f.read, f.broken,
     f.lost, f.unused, f.added_faces, f.no_area, f.repairs, f.failures, f.sewing);
}
template <typename Io>
void transfer(Io& io, Crossing& f) {
  io(f.face_a, f.face_b, f.at, f.depth, f.limit, f.one_body);
}
template <typename Io>
void transfer(Io& io, CrossingsAccount& f) {
  io(f.pairs, f.apart, f.neighbours, f.crossing, f.undecided, f.faces, f.faces_free,
     f.faces_crossing, f.faces_undecided, f.found, f.undecided_pairs);
}
template <typename Io>
void transfer(Io& io, SolidModel& f) {
  io(f.path, f.format, f.unit, f.schema, f.patches, f.faces, f.edges, f.facts, f.open_edges,
     f.moments, f.section, f.below, f.crossings, f.import, f.notices);
}
template <typename Io>
void transfer(Io& io, EditedFacts& f) {
  io(f.facts, f.refusal);
}
template <typename Io>
void transfer(Io& io, WriteReport& f) {
  io(f.written, f.refusal, f.before, f.rebuilt, f.reread, f.faces_identical,
     f.faces_bspline_untouched, f.analytic_ulps, f.edited_exact, f.written_by, f.lines_appended,
     f.lines_repointed, f.not_line_by_line, f.notices);
}

namespace internal {

template <>
struct Bytes<Patch> {
  static void write(ByteWriter& out, const Patch& p) {
    out(p.u_knots, p.v_knots, p.name, p.handle, p.points, p.weights, p.reversed, p.aliases, p.trim);
  }
  static Patch read(ByteReader& in) {
    auto u_knots = Bytes<KnotVector>::read(in);
    auto v_knots = Bytes<KnotVector>::read(in);
    Patch p{{}, {}, std::move(u_knots), std::move(v_knots), {}, {}, false, {}, {}};
    in(p.name, p.handle, p.points, p.weights, p.reversed, p.aliases, p.trim);
    return p;
  }
};

}  // namespace internal
}  // namespace isochor
