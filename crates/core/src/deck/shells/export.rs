//! Writes the skins of bodies as closed shells of quadrilaterals: OBJ, PLY, STL.
