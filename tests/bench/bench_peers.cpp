// bench_peers.cpp -- CGAL's and Boost's part of the benchmarks; see peers.h.
#include <algorithm>
#include <limits>
#include <numeric>
#include <vector>

#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Spatial_sort_traits_adapter_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>
#include <CGAL/property_map.h>
#include <CGAL/spatial_sort.h>
#include <CGAL/version.h>
#include <boost/graph/compressed_sparse_row_graph.hpp>
#include <boost/graph/edge_list.hpp>
#include <boost/graph/adjacency_list.hpp>
#include <boost/graph/kruskal_min_spanning_tree.hpp>
#include <boost/graph/prim_minimum_spanning_tree.hpp>
#include <boost/version.hpp>

#include "peers.h"

namespace
{

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_2;
using Points = std::vector<Point>;
using Delaunay = CGAL::Delaunay_triangulation_2<Kernel>;
using Height = CGAL::Triangulation_vertex_base_with_info_2<double, Kernel>;
using Surface =
    CGAL::Delaunay_triangulation_2<Kernel, CGAL::Triangulation_data_structure_2<Height>>;

void *points(const ivec3 *pts, size_t n)
{
    auto *p = new Points;

    p->reserve(n);
    for (size_t i = 0; i < n; i++)
        p->emplace_back(pts[i].x, pts[i].y);
    return p;
}

// Points in Hilbert order, and the face of each, where it was located.
struct Queries {
    std::vector<size_t> number; // of the point, as it was given
    Points point;
    std::vector<Surface::Face_handle> face;
};

void *queries(const ivec3 *pts, size_t n)
{
    using Map = CGAL::Pointer_property_map<Point>::type;
    using Order = CGAL::Spatial_sort_traits_adapter_2<Kernel, Map>;
    auto *q = new Queries;
    Points p;

    for (size_t i = 0; i < n; i++)
        p.emplace_back(pts[i].x, pts[i].y);
    q->number.resize(n);
    q->face.resize(n);
    std::iota(q->number.begin(), q->number.end(), size_t(0));
    CGAL::spatial_sort(q->number.begin(), q->number.end(),
                       Order(CGAL::make_property_map(p), Kernel()));
    for (size_t i : q->number)
        q->point.push_back(p[i]);
    return q;
}

void *triangulate(const void *p)
{
    const auto &pts = *static_cast<const Points *>(p);

    return new Delaunay(pts.begin(), pts.end());
}

void *merge(const void *t, const void *p)
{
    auto *out = new Delaunay(*static_cast<const Delaunay *>(t));
    Delaunay::Face_handle hint;

    for (const Point &q : static_cast<const Queries *>(p)->point)
        hint = out->insert(q, hint)->face();
    return out;
}

size_t vertices(const void *t)
{
    return static_cast<const Delaunay *>(t)->number_of_vertices();
}

size_t faces(const void *t)
{
    return static_cast<const Delaunay *>(t)->number_of_faces();
}

void *surface(const ivec3 *pts, size_t n)
{
    std::vector<std::pair<Point, double>> p;

    for (size_t i = 0; i < n; i++)
        p.emplace_back(Point(pts[i].x, pts[i].y), pts[i].z);
    return new Surface(p.begin(), p.end());
}

void locate(const void *s, void *p)
{
    const auto &dt = *static_cast<const Surface *>(s);
    auto &q = *static_cast<Queries *>(p);
    Surface::Face_handle hint;

    for (size_t i = 0; i < q.point.size(); i++)
        q.face[i] = hint = dt.locate(q.point[i], hint);
}

void interpolate(const void *s, const void *p, double *height)
{
    const auto &dt = *static_cast<const Surface *>(s);
    const auto &q = *static_cast<const Queries *>(p);

    for (size_t i = 0; i < q.point.size(); i++) {
        const auto face = q.face[i];
        const Point &at = q.point[i];
        double w[3], sum = 0, h = 0;

        if (dt.is_infinite(face)) {
            height[q.number[i]] = std::numeric_limits<double>::quiet_NaN();
            continue;
        }
        for (int k = 0; k < 3; k++) {
            const Point &a = face->vertex(Surface::ccw(k))->point();
            const Point &b = face->vertex(Surface::cw(k))->point();

            w[k] =
                (b.x() - a.x()) * (at.y() - a.y()) - (b.y() - a.y()) * (at.x() - a.x());
            sum += w[k];
        }
        for (int k = 0; k < 3; k++)
            h += w[k] * face->vertex(k)->info();
        height[q.number[i]] = h / sum;
    }
}

struct Length {
    double length;
};

// Prim reads a compressed graph, Kruskal a list of edges: the fastest of Boost's for each.
struct Graph {
    using Rows =
        boost::compressed_sparse_row_graph<boost::directedS, boost::no_property, Length>;
    using List = boost::adjacency_list<boost::vecS, boost::vecS, boost::undirectedS,
                                       boost::no_property, Length>;
    Rows rows;
    List list;
    std::vector<size_t> parent;
    std::vector<boost::graph_traits<List>::edge_descriptor> tree;
};

void *graph(uint32_t nv, const uint32_t (*edges)[2], const double *length, size_t n)
{
    std::vector<std::pair<size_t, size_t>> ends;
    std::vector<Length> len;
    auto *g = new Graph;

    for (size_t i = 0; i < n; i++) {
        ends.emplace_back(edges[i][0], edges[i][1]);
        ends.emplace_back(edges[i][1], edges[i][0]);
        len.push_back({length[i]});
        len.push_back({length[i]});
    }
    g->rows = Graph::Rows(boost::edges_are_unsorted_multi_pass, ends.begin(), ends.end(),
                          len.begin(), nv);
    g->list = Graph::List(nv);
    for (size_t i = 0; i < n; i++)
        boost::add_edge(edges[i][0], edges[i][1], Length{length[i]}, g->list);
    g->parent.resize(nv);
    g->tree.reserve(nv);
    return g;
}

void prim(void *p)
{
    auto &g = *static_cast<Graph *>(p);

    boost::prim_minimum_spanning_tree(
        g.rows, g.parent.data(), boost::weight_map(boost::get(&Length::length, g.rows)));
}

double kruskal(void *p)
{
    auto &g = *static_cast<Graph *>(p);
    double total = 0;

    g.tree.clear();
    boost::kruskal_minimum_spanning_tree(
        g.list, std::back_inserter(g.tree),
        boost::weight_map(boost::get(&Length::length, g.list)));
    for (const auto &e : g.tree)
        total += g.list[e].length;
    return total;
}

template <class T> void drop(void *p)
{
    delete static_cast<T *>(p);
}

} // namespace

extern "C" {
extern const peers peers_table;
const peers peers_table = {
    "CGAL " CGAL_VERSION_STR ", Boost " BOOST_LIB_VERSION,
    points,
    drop<Points>,
    queries,
    drop<Queries>,
    triangulate,
    merge,
    vertices,
    faces,
    drop<Delaunay>,
    surface,
    locate,
    interpolate,
    drop<Surface>,
    graph,
    prim,
    kruskal,
    drop<Graph>,
};
}
