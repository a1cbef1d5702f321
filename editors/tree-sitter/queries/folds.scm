[(param) (grid) (define) (function) (curve) (surface) (point) (vector) (metric) (geodesic) (solid) (light) (camera) (background)] @fold
